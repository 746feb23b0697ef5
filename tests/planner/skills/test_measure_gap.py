"""Passages that the robot measures: what is surely too wide for one is told so, and what is not is never."""

import pytest

import utak


def rooms(south: str, north: str) -> utak.Scenario:
    """Return two rooms with a door from one height to another, and a square of 4 in the western one."""
    inside = f"(2 2, 21 2, 21 {south}, 23 {south}, 23 2, 42 2, 42 20, 23 20, 23 {north}, 21 {north}, 21 20, 2 20, 2 2)"
    return utak.Scenario.from_text(
        world=f"""table(44, 22). verge("POLYGON ((0 0, 0 22, 44 22, 44 0, 0 0), {inside})").
        utak("POINT (10.5 14.5)", 0). object(g1, g, "POLYGON ((6 5, 6 9, 10 9, 10 5, 6 5))").""",
        start="object(x).",
        goal="in(x, room(next)).",
    )


@pytest.mark.long
@pytest.mark.parametrize(("south", "north"), [("9", "12"), ("9", "12.03"), ("8.5", "12.55"), ("9", "13.1")])
def test_what_is_measured_too_narrow_is_impossible_and_what_fits_is_not(south: str, north: str) -> None:
    """Doors between the squares look as narrow as others; 4.05 and 4.1 squares are wide enough."""
    episode = utak.Run(rooms(south, north), max_steps=120).finish()
    if float(north) - float(south) < 4:
        assert episode.verdict == "impossible" and "too narrow" in episode.reason
        measured = [step for step in episode if "how wide the passage" in step.line["why"]]
        assert len(measured) <= 5  # to the door, against each side and back from it
    else:
        assert episode.verdict not in ("impossible",)
