"""The benchmark of disturbed runs: its disturbances are valid, and its summary counts rows."""

import numpy as np
import pytest

from benchmarks.disturbed.run import DisturbedRow, disturbance, summary
from benchmarks.worlds.makers import scenario
from utak.kb.language.source_text import source_from_bytes
from utak.simulator.scenario.disturbances import disturbed_world
from utak.simulator.world.physics import Tabletop
from utak.simulator.world.world import Thing, World, outer_ring


@pytest.mark.parametrize("act", ["move", "lift", "appear", "vanish"])
def test_a_random_disturbance_can_happen(act: str) -> None:
    made = scenario(6, 3, "plain")
    things = tuple(Thing(thing.name, thing.colour, thing.polygon) for thing in made.things)
    world = World(made.plan.width, made.plan.height, made.plan.verge, things, (), (made.utak.x, made.utak.y), 0)
    lines = [{"utak": list(world.utak), "objects": {thing.name: outer_ring(thing.polygon) for thing in things}}] * 2
    fact, step = disturbance(act, np.random.default_rng(1), made, lines)
    assert step == 1 and fact.startswith(f"{act}(")
    table = Tabletop(disturbed_world(world, source_from_bytes("others", fact.encode())))
    table.release()
    assert table.disturbed and not table.refused


def test_the_summary_counts_rows_of_each_kind() -> None:
    rows = [
        DisturbedRow("move", 3, 0, noticed=True, placed=True, achieved=True, believed=True),
        DisturbedRow("move", 5, 0, noticed=False, placed=None, achieved=False, believed=True),
        DisturbedRow("lift", 1, 0, seen=True, looks=4, verdict="impossible"),
    ]
    move, lift = summary(rows)
    assert "2 worlds, done 1, noticed at once 1 of 2, place right 1 of 1, false done 1, impossible 0" in move
    assert "knows within 3 looks 0, of those put where it had looked 0 of 1" in lift and "impossible 1" in lift
