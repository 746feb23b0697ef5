"""Doors and rooms of drawn floors: doors of every width, thick walls, and no false doors."""

from dataclasses import replace

import numpy as np
import pytest

from tests.kb.drawings import known_model, unclear
from tests.planner.situations import situation_of
from utak.kb.perception.interpretation import interpret_regions
from utak.kb.perception.regions import map_regions
from utak.kb.world.model import MAX_FREE_PROBABILITY, WorldModel
from utak.kb.world.rooms import rooms_of
from utak.planner.deciding.search import island_contacts


def two_rooms(door: int, wall: int, high: int = 14, wide: int = 12) -> list[str]:
    """Return two rooms side by side with a door in the middle of the wall between them."""
    full = "b" * (2 * wide + wall + 4)
    south = (high - door) // 2
    rows = []
    for j in range(high):
        between = "." * wall if south <= high - 1 - j < south + door else "b" * wall
        rows.append("bb" + "." * wide + between + "." * wide + "bb")
    rows[3] = rows[3][:4] + "U" + rows[3][5:]
    return [full, full, *rows, full, full]


@pytest.mark.parametrize("wall", [1, 2, 3])
@pytest.mark.parametrize("door", [3, 4, 5, 6])
def test_a_door_between_two_rooms(door: int, wall: int) -> None:
    model = known_model(two_rooms(door, wall))
    rooms = rooms_of(model)
    assert len(rooms.doors) == 1
    assert rooms.doors[0].width == pytest.approx(door)
    assert rooms.doors[0].confidence == 100
    assert sorted(rooms.doors[0].sides) == [1, 2]
    assert sorted(np.unique(rooms.labels[model.floor]).tolist()) == [1, 2]
    row, column = model.view.locate(*model.place)
    assert rooms.labels[row, column] == 1
    x, y = rooms.doors[0].place
    assert 14 - 0.5 <= x <= 14 + wall + 0.5
    assert y == pytest.approx(2 + (14 - door) // 2 + door / 2, abs=0.51)


def unclear_between(first: int, last: int, chance: float) -> WorldModel:
    """Two rooms with a door 4 wide in rows 7 to 10, columns 14 and 15, where squares between the rooms are not settled.

    first, last : their rows. chance : that one is occupied.
    """
    model = unclear(known_model(two_rooms(4, 2)), slice(first, last + 1), slice(14, 16), chance)
    seen = model.view.seen
    percept, labels = map_regions(seen & (model.view.probability > MAX_FREE_PROBABILITY), seen, seen)
    return replace(model, labels=labels, percept=percept, kinds=interpret_regions(percept))


@pytest.mark.parametrize(("chance", "width"), [(0.1, 4), (0.4, 4), (0.6, 3), (0.9, 3)])
def test_a_door_is_sure_when_only_its_width_is_unclear(chance: float, width: int) -> None:
    rooms = rooms_of(unclear_between(7, 7, chance))
    assert [(door.confidence, door.width) for door in rooms.doors] == [(100, pytest.approx(width))]
    assert not rooms.labels[7, 14:16].any()  # squares that may be wall are part of no room


@pytest.mark.parametrize(("deep", "confidence"), [(1, 100), (2, 50)])  # 8 squares wide it is no door between such rooms
def test_an_unclear_jamb_counts_if_there_is_wall_close_behind(deep: int, confidence: int) -> None:
    rooms = rooms_of(unclear_between(7 - deep, 6, 0.9))
    assert [door.confidence for door in rooms.doors] == [confidence]


def test_a_door_half_of_which_may_be_wall_is_not_sure() -> None:
    assert not any(door.sure for door in rooms_of(unclear_between(7, 9, 0.3)).doors)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("wall", [1, 2, 3])
@pytest.mark.parametrize("door", [3, 4, 5, 6])
def test_a_room_ends_between_the_jambs(door: int, wall: int, turned: bool) -> None:
    rows = two_rooms(door, wall)
    model = known_model(turned_drawing(rows) if turned else rows)
    labels = np.where(model.floor, rooms_of(model).labels, 0)
    labels = np.rot90(labels, -1) if turned else labels
    assert set(np.unique(labels[:, :14]).tolist()) == {0, 1}
    assert set(np.unique(labels[:, 14 + wall :]).tolist()) == {0, 2}


@pytest.mark.parametrize("wall", [1, 2, 3])
def test_the_next_room_begins_behind_the_wall(wall: int) -> None:
    model = known_model(two_rooms(4, wall))
    beyond = rooms_of(model).beyond(1) & model.floor
    columns = np.flatnonzero(beyond.any(0))
    assert columns.min() == 14 + wall
    assert columns.max() == 14 + wall + 11
    behind = np.zeros_like(beyond)
    behind[:, 14 + wall :] = True
    assert not (beyond & ~behind).any()
    missing = np.argwhere(behind & model.floor & ~beyond)  # only right behind the door
    assert (missing[:, 1] <= 14 + wall + 1).all()
    assert len(missing) <= 2 * 6


def turned_drawing(rows: list[str]) -> list[str]:
    """Return a drawing rotated by a quarter turn."""
    return ["".join(column) for column in zip(*rows[::-1], strict=True)]


def test_a_quarter_turn_turns_the_rooms() -> None:
    rows = two_rooms(4, 2)
    for _ in range(4):
        rows = turned_drawing(rows)
        rooms = rooms_of(known_model(rows))
        assert [door.width for door in rooms.doors] == pytest.approx([4])


def bordered(rows: list[str]) -> list[str]:
    full = "b" * (len(rows[0]) + 4)
    return [full, full, *("bb" + row + "bb" for row in rows), full, full]


@pytest.mark.parametrize("arm", [6, 8, 10])
def test_an_l_shaped_room_has_no_door(arm: int) -> None:
    rows = ["." * arm + "b" * 14] * 14 + ["." * (arm + 14)] * arm
    rows[-2] = ".U" + rows[-2][2:]
    assert not rooms_of(known_model(bordered(rows))).doors


@pytest.mark.parametrize("size", [(8, 20), (20, 8), (15, 15), (30, 30)])
def test_an_empty_rectangular_room_has_no_door(size: tuple[int, int]) -> None:
    rows = ["." * size[0]] * size[1]
    rows[1] = "." * (size[0] - 1) + "U"
    rooms = rooms_of(known_model(bordered(rows)))
    assert not rooms.doors
    assert not rooms.beyond(1).any()


def test_objects_make_no_doors() -> None:
    rows = ["." * 20] * 20
    for j in (8, 9, 10):
        rows[j] = "...ggggg...hhhhhh..."
    rows[1] = "U" + "." * 19
    assert not rooms_of(known_model(bordered(rows))).doors


def test_an_object_in_the_door_leaves_the_door() -> None:
    rows = [row.replace("U", ".") for row in two_rooms(6, 2)]
    rows[14] = rows[14][:4] + "U" + rows[14][5:]
    middle = len(rows) // 2
    for j in (middle - 1, middle):
        rows[j] = rows[j][:14] + "gg" + rows[j][16:]
    assert [door.width for door in rooms_of(known_model(rows)).doors] == pytest.approx([6])


def test_three_rooms_in_a_row() -> None:
    left, right = two_rooms(4, 2), two_rooms(5, 2)
    rows = [a + b[2 + 12 :].replace("U", ".") for a, b in zip((r[:-2] for r in left), right, strict=True)]
    model = known_model(rows)
    rooms = rooms_of(model)
    assert sorted(door.width for door in rooms.doors) == pytest.approx([4, 5])
    assert len(np.unique(rooms.labels[model.floor])) == 3
    own = rooms.beyond(1) & model.floor
    columns = np.flatnonzero(own.any(0))
    assert (columns.min(), columns.max()) == (16, 27)  # only the middle room is next
    assert own.sum() >= 12 * 14 - 4 * 7


def test_a_door_is_known_by_its_jambs_before_the_room_behind_it_is_seen() -> None:
    rows = [row[:16] + "?" * (len(row) - 16) for row in two_rooms(4, 2)]
    rooms = rooms_of(known_model(rows))
    assert [door.width for door in rooms.doors] == pytest.approx([4])


def test_a_wall_with_a_jamb_unseen_has_no_door() -> None:
    drawn = two_rooms(6, 2)
    cuts = [13 if n > 8 else 16 for n in range(len(drawn))]
    rows = [row[:cut] + "?" * (len(row) - cut) for row, cut in zip(drawn, cuts, strict=True)]
    assert not rooms_of(known_model(rows)).doors


def test_floor_without_bounds_is_one_room() -> None:
    rows = ["." * 9] * 4 + ["....U...."] + ["." * 9] * 4
    rooms = rooms_of(known_model(rows))
    assert (rooms.labels == 1).all()
    assert not rooms.doors


def test_a_possible_object_makes_no_door() -> None:
    rows = [row.replace("U", ".") for row in two_rooms(6, 2)]
    rows[14] = rows[14][:4] + "U" + rows[14][5:]
    stub = [row[:20] + "gg" + row[22:] if 2 <= n < 9 else row for n, row in enumerate(rows)]
    model = known_model(["?" * len(row) if n < 5 else row for n, row in enumerate(stub)])
    may_be_object = model.verge & ~model.walls
    assert set(np.argwhere(may_be_object)[:, 1].tolist()) == {14, 15, 20, 21}  # and a wall as short as things
    assert {(16.0, 6.0), (20.0, 9.0)} in [{door.a, door.b} for door in rooms_of(model).doors]
    assert not rooms_of(model).sure
    assert not rooms_of(model, verge=model.walls).doors


@pytest.mark.parametrize(
    ("length", "sure", "surely_wall"), [(8, False, False), (12, False, False), (13, True, False), (26, True, True)]
)
def test_something_thirteen_squares_long_is_a_wall_beside_a_door(length: int, sure: bool, surely_wall: bool) -> None:
    """Likely a wall, that is: what is longer than any object surely is one."""
    wall = "b" * length + "." * 5 + "b" * 20
    floor = "." * (length + 5 + 18) + "bb"
    edge = "b" * len(wall)
    begin = floor[:-9] + "U" + floor[-8:]
    rows = [edge, *[floor] * 12, wall, wall, *[floor] * 11, begin, edge]
    # north and south of the room all but its western end is seen
    unseen = ["?" * 4 + row for row in rows]
    unseen[0] = unseen[-1] = "?" * 20 + edge[16:]
    model = known_model(unseen)
    (door,) = rooms_of(model).doors
    assert door.width == pytest.approx(5)
    assert door.sure == sure
    assert bool(rooms_of(model, verge=model.walls).doors) == surely_wall


def test_a_doorway_with_nothing_seen_behind_it_is_a_part_of_its_own() -> None:
    rows = [
        "............bbbb???",
        "............bbbb???",
        "............bbbb???",
        "............bbbb???",
        "..........Ubbbb????",
        "..bb..bb...bbbb????",
        "..bbbbbbbb.bbbb????",
        "..bbbbbbbb..bbb????",
        "..bbbbbbb...bbb????",
        "..bbbbbbb...bbb????",
        "?????????..bbbb????",
    ]
    rooms = rooms_of(known_model(rows))
    assert rooms.doors
    for door in rooms.doors:
        assert np.isin(door.sides, rooms.labels).all()
    assert np.unique(rooms.labels).tolist() == list(range(rooms.labels.max() + 1))


ISLAND = [  # two rooms, and a short piece of wall between two doors
    "b" * 34,
    *["b" + "." * 15 + "bb" + "." * 15 + "b"] * 2,
    *["b" + "." * 32 + "b"] * 4,
    *["b" + "." * 15 + "ww" + "." * 15 + "b"] * 5,
    *["b" + "." * 32 + "b"] * 4,
    *["b" + "." * 15 + "bb" + "." * 15 + "b"] * 2,
    "b..U" + "." * 12 + "bb" + "." * 15 + "b",
    "b" * 34,
]


@pytest.mark.parametrize("felt", [True, False])
def test_a_short_piece_of_wall_that_was_felt_is_the_jamb_of_two_doors(felt: bool) -> None:
    model = known_model(ISLAND)
    (node,) = model.objects
    beside = next(iter(node.patch.squares()))
    model = replace(model, felt={beside: "b"} if felt else {}, objects=())
    rooms = rooms_of(model, verge=model.verge | model.mask(node.patch))
    assert [round(door.width) for door in rooms.doors] == [4, 4]
    assert len(rooms.sure) == (2 if felt else 0)
    assert [aim.kind for aim in island_contacts(situation_of(known_model(ISLAND)))] == ["inspect"]
    assert not island_contacts(situation_of(known_model([row.replace("w", ".") for row in ISLAND])))
