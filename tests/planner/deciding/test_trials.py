"""What seems one thing is felt all round or moved by a square, another way where it did not move, before a verdict."""

from dataclasses import replace

from tests.planner.situations import all_felt, known_situation, situation_of, tools_with, turn_of
from utak.kb.body import Grasp, Move, Push, Release
from utak.kb.language.reader import facts_from_text
from utak.kb.objects.movability import way_of
from utak.planner.deciding.trials import Trials
from utak.planner.situation import Situation
from utak.planner.stages import Stage

SMALL = ["bbbbbbbbbbbb", "b..........b", "b..gg......b", "b..gg...U..b", "b..........b", "bbbbbbbbbbbb"]
LARGE = ["b" * 24, *["b" + "." * 22 + "b"] * 2, *["b..gggggggggggggg......b"] * 5, "b....................U.b", "b" * 24]
ELSEWHERE = Stage(facts_from_text("at(x, corner(northeast))."))
OTHERS = ("east", "south", "west")  # than the north, where a thing was pushed in vain
WALK = Stage(facts_from_text("in(utak, room(next))."))


def felt(rows: list[str], bound: str = "", untried: tuple[str, ...] = (), moved: bool = False) -> Situation:
    """Return the situation of a robot that felt everything. bound : what the parameter x means."""
    model = all_felt(known_situation(rows, moved).model)
    objects = tuple(replace(node, resisted=("north",) * bool(untried), untried=untried) for node in model.objects)
    return situation_of(replace(model, objects=objects), {"x": bound} if bound else {})


def test_things_are_felt_all_round_first() -> None:
    found = (Trials().next((), turn_of(ELSEWHERE, known_situation(rows))) for rows in (SMALL, LARGE))
    assert all("felt all round" in decision.why for decision in found)


def test_what_was_felt_all_round_and_never_pushed_is_moved_once() -> None:
    never = felt(SMALL)
    assert "g can be grasped" in Trials().next((), turn_of(ELSEWHERE, never)).why
    tried = tuple(replace(node, resisted=("north",)) for node in never.model.objects)
    assert Trials().next((), turn_of(ELSEWHERE, situation_of(replace(never.model, objects=tried)))).result == "idle"


def test_nothing_is_moved_for_that_while_walls_were_never_felt() -> None:
    """The verdict rests on these then."""
    model = felt(SMALL).model
    walls = situation_of(
        replace(model, felt={square: colour for square, colour in model.felt.items() if colour != "b"})
    )
    assert Trials().next((), turn_of(ELSEWHERE, walls)).result == "idle"


def test_what_was_moved_is_one_thing() -> None:
    assert Trials().next((), turn_of(ELSEWHERE, felt(SMALL, moved=True))).result == "idle"


def test_what_a_goal_speaks_of_is_not_moved() -> None:
    assert Trials().next(ELSEWHERE.goals, turn_of(ELSEWHERE, felt(SMALL, "g", OTHERS))).result == "idle"


def test_what_did_not_move_is_pushed_other_ways_each_once() -> None:
    model, trials, tools, pushes = felt(SMALL, "", OTHERS).model, Trials(), tools_with(), list[str]()
    for _ in range(40):
        turn = turn_of(ELSEWHERE, situation_of(model), tools)
        begun = trials.is_pushing(turn.situation)
        command = (trials.go_on(turn) if begun else trials.next((), turn)).command
        if command is None and not begun:
            break
        if isinstance(command, Push):
            pushes.append(way_of(command))
            (node,) = model.objects
            left = tuple(way for way in node.untried if way != pushes[-1])
            model = replace(model, objects=(replace(node, resisted=("north", *pushes), untried=left),))
        held = "g" if isinstance(command, Grasp) else None if isinstance(command, Release) else model.held
        at = (command.east, command.north) if isinstance(command, Move) else (0.0, 0.0)
        model = replace(model, held=held, place=(model.place[0] + at[0], model.place[1] + at[1]))
    assert sorted(pushes) == sorted(OTHERS)


def test_where_no_thing_matters_none_is_tried() -> None:
    assert Trials().next((), turn_of(WALK, known_situation(SMALL))).result == "idle"
