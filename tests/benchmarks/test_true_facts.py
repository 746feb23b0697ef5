"""No fact that is stated as known contradicts the table, in random worlds without noise; and a false one is found."""

from pathlib import Path

import pytest
import shapely

from benchmarks.claims.asked import Asked, written
from benchmarks.claims.true_facts import TrueTable, false_facts, false_in_run, main
from tests.tables import few

WORLDS = [Asked("own_plain", 9100, task) for task in range(1, 10)] + [
    Asked("own_wide", 9100, task) for task in (2, 6, 9)
]
ROOM = shapely.box(0, 0, 30, 20).difference(shapely.box(1, 1, 14, 19)).difference(shapely.box(15, 1, 29, 19))
TABLE = TrueTable(
    ROOM.difference(shapely.box(13, 8, 16, 12)), {"a": shapely.box(3, 3, 6, 6), "b": shapely.box(8, 3, 10, 6)},
    30, 20, (7.5, 4.5), 0.0, (7.5, 4.5),
)  # fmt: skip
THINGS = ["offset(o1,-300,0)", "offset(o2,150,0)", "threshold(d1,700,350,700,750)", "width(d1,400)"]
FACTS = {  # each with whether it is false
    "adjacent(o2,org,100)": False,
    "adjacent(org,o1,100)": True,
    "adjacent(o1,o2,100)": True,
    "adjacent(o1,o2,99)": False,
    "adjacent(org,verge,100)": True,
    "door(d1,100)": False,
    "width(d1,400,608)": False,
    "width(d1,450,608)": True,
    "corner(southwest,-650,-350,100)": False,
    "corner(southwest,-550,-350,100)": True,
}


@pytest.mark.parametrize("world", few(WORLDS, 2), ids=lambda asked: asked.name)
def test_no_known_fact_is_false(world: Asked, tmp_path: Path) -> None:
    written(world, tmp_path)
    assert false_in_run(tmp_path)[1] == []


def test_known_facts_are_compared(tmp_path: Path) -> None:
    written(WORLDS[1], tmp_path)
    assert false_in_run(tmp_path)[0].total() > 0


@pytest.mark.parametrize("fact", FACTS)
def test_false_facts_are_found(fact: str) -> None:
    facts = [*THINGS, fact, *([] if fact.startswith("door") else ["door(d1,99)"])]
    facts += [] if fact.startswith("width") else ["width(d1,400,608)"]
    found = list(false_facts(facts, TABLE))
    assert bool(found) == FACTS[fact], found


def test_two_rooms_are_not_one() -> None:
    inside = ["in(o1,r1,100)", "in(o2,r1,100)", "door(d1,99)", "width(d1,400,608)"]
    assert not list(false_facts([*THINGS, *inside], TABLE))
    beyond = TABLE._replace(things={**TABLE.things, "b": shapely.box(20, 3, 22, 6)})
    other = [fact.replace("offset(o2,150,0)", "offset(o2,1350,0)") for fact in THINGS]
    assert list(false_facts([*other, *inside], beyond)) == ["in(o1,r1,100), in(o2,r1,100)"]


def test_the_program_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    written(Asked("own_plain", 9100, 1), tmp_path)
    assert main([str(tmp_path)]) == 0
    assert "0 false; stated:" in capsys.readouterr().out
