"""The believed map is drawn from facts alone, and any facts can be drawn."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.repl.picture import DOOR_MARK, draw_belief


def ring(node: str, *corners: tuple[int, int]) -> list[str]:
    """The outline of a node through corners in squares, as facts in hundredths."""
    ends = zip(corners, [*corners[1:], corners[0]], strict=True)
    return [
        f"segment({node},{n},{100 * a},{100 * b},{100 * c},{100 * d},99)." for n, ((a, b), (c, d)) in enumerate(ends)
    ]


def box(node: str, west: int, south: int, east: int, north: int) -> list[str]:
    return ring(node, (west, south), (east, south), (east, north), (west, north))


ROOM = [
    *ring("verge", (0, 0), (12, 0), (12, 6), (0, 6)),
    *[f.replace("(verge,", "(verge,9") for f in ring("verge", (1, 1), (1, 5), (11, 5), (11, 1))],  # its hole
    *box("floor", 1, 1, 11, 5),
    *box("o1", 2, 2, 4, 4),
    *box("o2", 8, 1, 9, 2),
    "kind(o1,object,95).", "kind(o2,object,20).", "kind(o2,verge,80).", "shape(o1,square,88).", "colour(o1,g,99).",
    "offset(org,650,250).", "in(org,r1).", "door(d1,80).", "width(d1,200).", "connects(d1,r1,r2,80).",
    "threshold(d1,1000,100,1000,500).", "bound(x,o1).", "held(o1).",
]  # fmt: skip
DRAWN = """\
   5.5 ############
       #.........=#
       #.AA......=#
       #.AA..U...=#
       #.......b.=#
   0.5 ############
       |0.5      |1"""


def test_floor_walls_objects_doors_and_utak_are_drawn() -> None:
    picture = draw_belief(ROOM)
    assert [row.rstrip() for row in picture.rows] == DRAWN.replace("|1", "|10.5").splitlines()
    legend = "\n".join(picture.legend)
    assert "east 6.5, north 2.5, in r1" in legend
    assert "A o1: an object 95 %, square 88 %, colour g, in hand, meant by x" in legend
    assert "b o2: an object 20 %" in legend
    older = [
        {"door(d1,80).": "door(d1).", "connects(d1,r1,r2,80).": "connects(d1,r1,r2)."}.get(one, one) for one in ROOM
    ]
    assert f"{DOOR_MARK} d1: a door 100 % between r1 and r2, 2 wide" in "\n".join(draw_belief(older).legend)
    assert f"{DOOR_MARK} d1: a door 80 % between r1 and r2, 2 wide" in legend
    assert "1 x 1 square" in legend


def test_what_was_not_seen_is_blank() -> None:
    rows = draw_belief([*box("floor", 0, 0, 3, 2), *box("verge", 6, 0, 8, 2)]).rows
    assert [row[7:] for row in rows[:2]] == ["...   ##"] * 2


def test_a_turned_floor_is_drawn_by_the_middles_of_squares() -> None:
    rows = draw_belief(ring("floor", (0, -4), (4, 0), (0, 4), (-4, 0))).rows
    counts = [row[7:].count(".") for row in rows[:-1]]
    assert counts == [2, 4, 6, 8, 8, 6, 4, 2] or sum(counts) == 32
    assert counts == counts[::-1]


@pytest.mark.parametrize("width", [20, 60, 100])
def test_a_wide_map_has_several_squares_to_a_character(width: int) -> None:
    picture = draw_belief([*box("floor", 0, 0, 300, 90), "offset(org,15000,4500)."], width)
    assert max(map(len, picture.rows[:-1])) <= width
    assert any("squares;" in line and "1 x 1" not in line for line in picture.legend)
    assert sum(row.count("U") for row in picture.rows) == 1


def test_more_objects_than_letters_are_drawn() -> None:
    facts = [fact for n in range(40) for fact in (*box(f"o{n}", 2 * n, 0, 2 * n + 1, 1), f"kind(o{n},object,90).")]
    picture = draw_belief([*box("floor", 0, -1, 80, 3), *facts])
    assert "A" in picture.rows[2] and "*" in picture.rows[2]
    assert len([line for line in picture.legend if " o3" in line]) == 11


def test_nothing_believed_is_said() -> None:
    assert draw_belief([]).rows == ()
    assert draw_belief(["node(o1)."]).legend == ("nothing that could be drawn is believed",)


numbers = st.one_of(st.integers(-500, 500), st.integers(-(2**31), 2**31 - 1), st.sampled_from(["x", "", "1e9", '"a"']))


@given(
    st.lists(
        st.tuples(st.sampled_from(["segment", "offset", "threshold", "kind", "width", "door", "node"]),
                  st.lists(st.one_of(numbers, st.sampled_from(["org", "o1", "floor", "d1", "object"])), max_size=8)),
        max_size=12,
    ),
    st.sampled_from([None, 1, 40, 200]),
)  # fmt: skip
def test_any_facts_can_be_drawn(facts: list[tuple[str, list[object]]], width: int | None) -> None:
    picture = draw_belief([f"{name}({','.join(map(str, parts))})." for name, parts in facts], width)
    assert picture.legend
    assert all(len(row) <= 600 for row in picture.rows)
    assert len(picture.rows) <= 1_000_000
