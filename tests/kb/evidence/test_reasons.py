"""Why facts are believed: every reason is confirmed by checks that share no code with what made it."""

import json
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import clingo
import pytest

from benchmarks.harness.reasons import complaints, covers
from tests.tables import few
from utak.kb.evidence.proving import reason_of_proof
from utak.kb.evidence.reason import MAX_LEVELS, Depth, Reason, ReasonKind
from utak.kb.explanation.values import ProofNode
from utak.kb.language.atoms import atom_parts
from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.vocabulary import SETTLING_WORDS
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import read_episode
from utak.simulator.explaining.questions import Questions, questions_of_episode

ROOT = Path(__file__).resolve().parent.parent.parent.parent
RUNS = [("go_next_room_askew", "0"), ("push_l_tight_door", "0"), ("push_square_next_room", "0.05")]
STRIDE = 7  # every seventh fact of a step is explained here; benchmarks.episodes.explanations explains all


@pytest.fixture(scope="module", params=few([(run,) for run in RUNS], 1), ids=lambda run: f"{run[0]}-{run[1]}")
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Questions, list[Any]]:
    name, noise = request.param
    log = tmp_path_factory.mktemp("reasons") / f"{name}.jsonl"
    options = ["--noise", noise, "--seed", "5", "--max-steps", "12", "--log", str(log)]
    assert main(["run", str(ROOT / "examples" / name), *options]) in (0, 1, 75)
    episode = read_episode(log)
    return questions_of_episode(episode), list(episode.steps)


def test_every_fact_rests_on_cells_or_witnesses(run: tuple[Questions, list[Any]]) -> None:
    questions, lines = run
    names = set()
    for line in lines:
        for fact in line["belief"]["facts"][line["step"] % STRIDE :: STRIDE]:
            tree = questions.why(fact, line["step"]).as_dict()
            assert tree["claim"] == fact.removesuffix(".")
            assert list(complaints(lines, tree)) == [], (line["step"], fact)
            names.add(fact.partition("(")[0])
    assert {"kind", "offset", "segment", "shape", "rect"} <= names


def test_cells_cover_the_squares_that_they_are_said_to_show(run: tuple[Questions, list[Any]]) -> None:
    questions, lines = run
    step, checked = len(lines) - 1, 0
    for fact in lines[step]["belief"]["facts"]:
        if not re.match(r"(segment|kind)\(o\d", fact):
            continue
        leaf = next(r for r in questions.why(fact, step).walk() if r.kind == ReasonKind.CELLS)
        for impression, cell, _, square in leaf.data["cells"]:
            assert covers(lines, step, impression, cell, square), (fact, impression, cell, square)
            checked += 1
    assert checked or not re.search(r"kind\(o\d", "".join(lines[step]["belief"]["facts"]))


def test_all_160_cells_are_accounted_for(run: tuple[Questions, list[Any]]) -> None:
    questions, lines = run
    line = lines[-1]
    for cell in range(160):
        tree = questions.why_cell(cell, line["step"]).as_dict()
        assert list(complaints(lines, tree)) == []
        word = {"p": "predicted", "e": "explained", "n": "noise"}[line["belief"]["status"][cell]]
        assert tree["because"].startswith(word)


def test_every_command_and_the_verdict_have_a_reason(run: tuple[Questions, list[Any]]) -> None:
    questions, lines = run
    for line in lines[1:]:
        tree = questions.why_step(line["step"]).as_dict()
        assert list(complaints(lines, tree)) == []
        assert tree["because"] == line["why"]
        assert tree["rests_on"]
    verdict = questions.why("verdict(V)")
    assert list(complaints(lines, verdict.as_dict())) == []
    assert verdict.rests_on


def test_a_variable_stands_for_anything(run: tuple[Questions, list[Any]]) -> None:
    questions, _ = run
    assert questions.why("kind(utak, K, _)").claim == "kind(org,utak,100)"


@pytest.mark.parametrize(
    "fact", ["", "shape(", "shape(o1, square", "a. b", "offset(org, 1)", "-kind(o1,object,95)", "verdict(7)", '"', "X"]
)
def test_what_is_no_believed_fact_is_refused_with_its_place(run: tuple[Questions, list[Any]], fact: str) -> None:
    with pytest.raises(BadInputError, match="why:1:"):
        run[0].why(fact)


def test_why_not_says_nothing_untrue_of_goals_things_and_verdicts(run: tuple[Questions, list[Any]]) -> None:
    """A goal that is not attained yet, a thing that is there and not held, and a goal of nobody's."""
    questions, lines = run
    (goal, *_) = questions._task_at(0).goals
    reason = questions.why_not(goal, 0)
    assert (reason.claim, reason.because) == (f"not {goal}", "it is not concluded that this goal holds yet")
    with pytest.raises(BadInputError, match="is a word of goals, and this is no goal of the task"):
        questions.why_not("beside(o1, o2)", 0)
    facts = {fact.removesuffix(".") for fact in lines[0]["belief"]["facts"]}
    for node in sorted(fact[5:-1] for fact in facts if fact.startswith("node(o")):
        if node.startswith("o") and node != "org":
            assert questions.why_not(f"held({node})", 0).because.startswith(f"{node} is believed to be there")
    cut = Questions({"task": {"goals": [goal]}}, lines, None)
    assert cut.why_not("verdict(done)").because == "no verdict is recorded: the run goes on, or was cut short"


def test_a_command_is_explained_by_the_goal_that_counted_then(run: tuple[Questions, list[Any]]) -> None:
    """After a fork or a change at the prompt the goals are others, from the command after that step on."""
    _, lines = run
    old, new = "at(utak,start)", "at(utak,corner(southwest))"
    forked = {"task": {"goals": [new]}, "forked": [{"until": 1, "task": {"goals": [old]}}]}
    changed = {"task": {"goals": [old]}, "changes": [{"step": 1, "goal": "at(utak, corner(southwest))."}]}
    for header in (forked, changed):
        asked = Questions(header, lines[:3])
        for step, goal in ((1, old), (2, new)):
            claims = [reason.claim for reason in asked.why_step(step).rests_on]
            assert {old, new} & set(claims) == {goal}


def test_places_are_said_from_where_they_are_counted(run: tuple[Questions, list[Any]]) -> None:
    """All but the floor lie from where the robot woke; the floor, which begins there, lies from where the robot is."""
    questions, lines = run
    for line in lines:
        told = {}
        for fact in line["belief"]["facts"]:
            if fact.startswith("offset("):
                words = questions.why(fact, line["step"]).because
                east, north = re.findall(r"(-?[\d.]+) (?:squares east|north)", words)
                told[fact[7:].partition(",")[0]] = float(east), float(north), words
        *place, words = told.pop("org")
        assert place == pytest.approx(line["belief"]["place"], abs=0.006)
        assert told.pop("floor")[:2] == pytest.approx([-value for value in place])
        assert all(
            one.endswith("of where the robot believes that it woke")
            for one in (words, *(one for *_, one in told.values()))
        )


def test_a_step_or_a_cell_that_is_not_there_is_refused(run: tuple[Questions, list[Any]]) -> None:
    questions, lines = run
    with pytest.raises(BadInputError, match="there is no step"):
        questions.why("node(org)", len(lines))
    with pytest.raises(BadInputError, match="there is no cell"):
        questions.why_cell(160)


def test_depths_show_more_and_more(run: tuple[Questions, list[Any]]) -> None:
    reason = run[0].why("offset(utak, E, N)")
    short, mid, long = (reason.text(depth) for depth in (Depth.SHORT, Depth.MID, Depth.LONG))
    assert "\n" not in short
    assert mid.startswith(short)
    assert len(mid) <= len(long)


def test_a_reason_may_rest_on_any_number_of_levels() -> None:
    """A proof that is higher than Python's limit on recursion becomes a reason; MAX_LEVELS levels of it are written."""
    node = ProofNode("given", "up(0)", "up(0)")
    for number in range(1, 3_000):
        node = ProofNode("derived", f"up({number})", "", None, (node, node))
    reason = reason_of_proof(node, lambda fact: Reason(fact, "", ReasonKind.CELLS))
    assert [one.claim for one in reason.walk()] == [f"up({number})" for number in range(2_999, -1, -1)]
    lines = reason.text(Depth.LONG).split("\n")
    assert (len(lines), lines[-1].strip()) == (MAX_LEVELS + 1, "...")
    whole = json.loads(json.dumps(reason.as_dict()))
    for _ in range(MAX_LEVELS - 1):
        assert "cut" not in whole
        (whole,) = whole["rests_on"]
    assert whole["cut"] is True


def test_what_stands_twice_is_written_once() -> None:
    leaf = Reason("a", "seen", ReasonKind.CELLS)
    tree = Reason("c", "both", ReasonKind.RULE, rests_on=(leaf, Reason("b", "by a", ReasonKind.RULE, rests_on=(leaf,))))
    assert tree.text(Depth.LONG).splitlines() == ["c: both", "  a: seen", "  b: by a", "    a (as above)"]


def test_an_episode_without_a_record_says_so(run: tuple[Questions, list[Any]]) -> None:
    _, lines = run
    old = json.loads(json.dumps(lines))
    for line in old:
        for key in ("solved", "status", "origin", "regions", "moved", "map_from"):
            line["belief"].pop(key)
    questions = Questions({"task": {"goals": ["at(utak,x)"]}}, old)
    with pytest.raises(BadInputError, match="older version"):
        questions.why("kind(floor, floor, C)")


@pytest.mark.long
def test_what_is_missing_makes_a_fact_hold(run: tuple[Questions, list[Any]]) -> None:
    """A change that whynot names makes plain clingo derive the atom; without any member of it, it does not."""
    questions, lines = run
    step = len(lines) - 1
    objects = [
        fact.removesuffix(".") for fact in lines[step]["belief"]["facts"] if re.match(r"kind\(o\d+,object", fact)
    ]
    for fact in objects[:2]:
        node = fact[len("kind(") : fact.index(",")]
        reason = questions.why_not(f"shape({node}, disc, 98)", step)
        if not reason.data["found"] or reason.data["partial"] or "atom" not in reason.data:
            continue
        call = next(c for c in reversed(questions.beliefs.record.decisions(step)) if c.encoding == "shapes")
        missing, in_way = set(reason.data["missing"]), set(reason.data["in_way"])
        changed = set(call.facts) - in_way | missing
        assert derives("shapes", changed, reason.data["atom"])
        for one in missing:
            assert not derives("shapes", changed - {one}, reason.data["atom"])
        for one in in_way:
            assert not derives("shapes", changed | {one}, reason.data["atom"])


def derives(encoding: str, facts: set[str], atom: str) -> bool:
    """Return whether the answer of an encoding to some facts holds an atom."""
    control = clingo.Control(["--warn=none"])
    control.load(str(next(ROOT.glob(f"*/asp/{encoding}.lp"))))
    control.add("base", [], "".join(f"{fact}.\n" for fact in facts))
    control.ground([("base", [])])
    found: list[str] = []
    control.solve(on_model=lambda model: found.extend(map(str, model.symbols(shown=True))))
    return atom in found


def test_what_is_believed_has_no_reason_to_be_absent(run: tuple[Questions, list[Any]]) -> None:
    with pytest.raises(BadInputError, match="is believed"):
        run[0].why_not("kind(org, utak, C)")
    assert run[0].why_not("node(o99)").kind == ReasonKind.NEGATION
    assert run[0].why_not("verdict(nonsense)").rests_on


def test_an_outline_that_crosses_itself_is_refused_and_raises_nothing_else(run: tuple[Questions, list[Any]]) -> None:
    _, lines = run
    broken = json.loads(json.dumps(lines[:1]))
    crossing = [(0, 0), (300, 300), (300, 0), (0, 300), (150, -100), (150, 400)]
    corners = [*crossing, crossing[0]]
    facts = [f"segment(o9,{n},{a[0]},{a[1]},{b[0]},{b[1]},0)." for n, (a, b) in enumerate(pairwise(corners))]
    broken[0]["belief"]["facts"] += [*facts, "rect(o9,0,-100,300,400)."]
    questions = Questions({"task": {"goals": ["at(utak,x)"]}}, broken)
    try:
        assert questions.why("rect(o9, A, B, C, D)").rests_on
    except BadInputError as refused:
        assert "why:1:" in str(refused)


def test_what_is_said_of_things_in_hand_rooms_and_plans_is_so(run: tuple[Questions, list[Any]]) -> None:
    """What is hardly an object, what was in hand before, what is open, links through doors, and steps of the plan."""
    questions, lines = run
    stated = [[fact.removesuffix(".") for fact in line["belief"]["facts"]] for line in lines]
    held = {fact: step for step, facts in enumerate(stated) for fact in facts if fact.startswith("held(")}
    for fact, last in held.items():
        if last < len(lines) - 1:
            because = questions.why_not(fact, len(lines) - 1).because
            assert because.startswith(f"it was in hand up to step {last} and is no longer")
    for step, facts in enumerate(stated):
        for fact in facts:
            name, arguments = atom_parts(fact)
            if name not in ("movable", "unseen", "crosses", "borders", "plan", "serves", "room"):
                continue
            why = questions.why(fact, step)
            below = [reason.claim for reason in why.rests_on]
            if name == "movable" and arguments[1] == "0" and below[0] == "it was never tried":
                assert [atom_parts(claim)[0] for claim in below[1:]] == ["kind", "kind"]
            elif name == "unseen":
                assert [reason.kind for reason in why.rests_on] == [ReasonKind.MEASURED]
            elif name == "crosses":
                assert [atom_parts(claim)[0] for claim in below] == ["link", "threshold"]
            elif name == "borders":
                assert [atom_parts(claim)[0] for claim in below] == ["link", "rect"]
            elif name == "plan":
                settles = arguments[1].partition("(")[0] in SETTLING_WORDS
                assert settles != (" geometry " in why.because)
            elif name == "serves":
                assert why.because == f"step {arguments[0]} of the plan is for goal {arguments[1]}"
            elif name == "room" and f"connects(d1,{arguments[0]}," in " ".join(facts):
                assert below[0].startswith("door(d1,")


def test_the_middle_depth_lists_the_nearest_rivals_alone() -> None:
    rivals = [Reason(f"not chosen: a{n}", "", ReasonKind.REJECTED, data={"costs": []}) for n in range(5)]
    reason = Reason("chosen", "", ReasonKind.RULE, rests_on=(*rivals, Reason("missing: b", "", ReasonKind.REJECTED)))
    told = reason.text().splitlines()
    assert told[1:4] == [f"  not chosen: a{n}" for n in range(3)]
    assert told[4:] == ["  missing: b", "  not chosen: 2 more, which come less near (depth long lists them)"]
    assert len(reason.text(Depth.LONG).splitlines()) == 7
