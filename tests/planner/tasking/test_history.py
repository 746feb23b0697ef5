"""What was done is remembered by things, whatever they are called."""

from dataclasses import replace

import shapely

from tests.planner.situations import BESIDE_A_THING, known_situation
from utak.kb.task.task import Task
from utak.kb.world.model import WorldModel
from utak.planner.deciding.keeping import ConstraintKeeper
from utak.planner.situation import Situation
from utak.planner.tasking.history import DoneErrands

AWAY = 4.0  # squares by which the thing is moved


def test_a_thing_that_gets_another_name_keeps_its_past() -> None:
    """It was moved, is taken for a part of the map again, and is called o9: it lay here, and lies where it was put."""
    situation = known_situation(BESIDE_A_THING, moved=True)
    (node,) = situation.model.objects
    away = shapely.affinity.translate(node.polygon, AWAY, 0.0)
    moved = replace(situation.model, objects=(replace(node, polygon=away),))
    renamed = replace(situation.model, objects=(replace(node, polygon=away, name="o9", moved=False),))
    keeper, history = ConstraintKeeper(Task({}, (), ())), DoneErrands()

    def noted(model: WorldModel) -> Situation:
        """Return the situation after a model was noted by both."""
        keeper.note(model)
        now = replace(situation, model=model, carried=keeper.middles(model), renamed=dict(keeper.renamed))
        history.note(now)
        return now

    for model in (situation.model, moved):
        noted(model)
    now = noted(renamed)
    assert {name: len(track) for name, track in now.carried.items()} == {"o9": 2}
    assert history.places(now) == {"o9": "put_0"}
    assert history.facts(now, {"o9"}) == ("done(clear(o9,put_0),0)", "lay(o9,here,0)", "lay(o9,put_0,1)")


def test_what_arrived_is_past_and_what_is_on_its_way_is_not() -> None:
    """A plan may go on with a thing that was put down on its way: that is one errand with what follows."""
    situation = known_situation(BESIDE_A_THING, moved=True)
    track = {"o1": ((1.0, 1.0), (5.0, 1.0))}
    history = DoneErrands()
    for now in (replace(situation, carried={"o1": track["o1"][:1]}), replace(situation, carried=track)):
        history.note(now)
    assert [fact for fact in history.facts(now) if fact.startswith("done")] == []
    assert [fact for fact in history.facts(now, {"o1"}) if fact.startswith("done")] == ["done(clear(o1,put_0),0)"]
