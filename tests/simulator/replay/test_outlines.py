"""Facts come back from their outlines just as they were."""

from hypothesis import given
from hypothesis import strategies as st

from simulator.replay.packed.outlines import AS_THE_OTHER_WAY, joined_facts, split_facts

POINTS = st.tuples(st.integers(-300, 300), st.integers(-300, 300))
RINGS = st.lists(st.lists(POINTS, min_size=1, max_size=8), max_size=4)


def outline(name: str, rings: list[list[tuple[int, int]]], sure: int = 50) -> list[str]:
    """Return the facts of an outline, with its rectangle."""
    edges = [(a, b) for ring in rings for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)]
    facts = [f"segment({name},{n},{a[0]},{a[1]},{b[0]},{b[1]},{(sure + n) % 101})." for n, (a, b) in enumerate(edges)]
    if edges:
        easts, norths = zip(*(a for a, _ in edges), strict=True)
        facts.append(f"rect({name},{min(easts)},{min(norths)},{max(easts)},{max(norths)}).")
    return facts


@given(st.dictionaries(st.sampled_from(["floor", "o1", "o12", "verge"]), RINGS), st.lists(st.sampled_from("abc")))
def test_facts_come_back(outlines: dict[str, list[list[tuple[int, int]]]], others: list[str]) -> None:
    facts = sorted(
        {fact for name, rings in outlines.items() for fact in outline(name, rings)} | {f"{o}." for o in others}
    )
    split = split_facts(facts)
    assert split is not None
    assert joined_facts(split) == facts
    assert split.others == sorted({f"{o}." for o in others})


def test_an_edge_of_two_outlines_has_its_confidence_once() -> None:
    square = [(0, 0), (100, 0), (100, 100), (0, 100)]
    facts = sorted(
        f"segment({name},{n},{a[0]},{a[1]},{b[0]},{b[1]},70)."
        for name, ring in (("floor", square), ("verge", square[::-1]))
        for n, (a, b) in enumerate(zip(ring, [*ring[1:], ring[0]], strict=True))
    )
    facts = sorted([*facts, "rect(floor,0,0,100,100).", "rect(verge,0,0,100,100)."])
    split = split_facts(facts)
    assert split is not None
    assert split.confidences == {"floor": [70] * 4, "verge": [AS_THE_OTHER_WAY] * 4}
    assert joined_facts(split) == facts


def test_facts_of_another_form_are_not_split() -> None:
    triangle = outline("o1", [[(0, 0), (100, 0), (0, 100)]])
    for facts in (
        sorted(triangle, reverse=True),  # not sorted
        sorted([*triangle, triangle[0]]),  # stated twice
        sorted(triangle[:-1]),  # no rectangle
        sorted([*triangle[:1], *triangle[2:]]),  # an edge is missing
        sorted(["rect(o1,0,0,1,1).", *triangle[:-1]]),  # another rectangle
        sorted([fact.replace("segment(o1,2", "segment(o1,7") for fact in triangle]),  # a number is missing
        sorted([fact.replace("segment(o1,1", "segment(o1,01") for fact in triangle]),
        sorted([fact.replace(",50).", ",-5).") for fact in triangle]),
    ):
        assert split_facts(facts) is None or joined_facts(split_facts(facts)) == facts  # type: ignore[arg-type]
    assert split_facts(sorted(triangle[:-1])) is None
    assert split_facts(sorted(triangle, reverse=True)) is None
