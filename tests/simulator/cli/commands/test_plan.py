"""The task plan of a run: in facts, queries, `utak plan`, explanations, text replay, programs and Python.

In the scenario a movable block stands before the door through which a square shall be pushed.
"""

import io
import json
from pathlib import Path
from typing import Any

import clingo
import pytest

import utak
from benchmarks.harness.reasons import complaints
from utak.simulator.cli.main import main
from utak.simulator.episode.episode import Episode, encode, read_episode
from utak.simulator.episode.schema import accepts
from utak.simulator.explaining.questions import questions_of_episode
from utak.simulator.replay.transcript import transcript

STEPS = 5  # commands of the recorded run: after the last one the block is aside, and its plan goes on
WORLD = """\
bbbbbbbbbbbbbbbbbbbbbbbbbb
b...........b............b
b...........b............b
b...........b............b
b.........gg.............b
b.........gg.............b
b........................b
b..rr.......b............b
b..rr.......b............b
b.......U...b............b
b...........b............b
bbbbbbbbbbbbbbbbbbbbbbbbbb
"""
START = "object(x). colour(x, r). shape(x, square).\n"
GOAL = "in(x, room(next)). at(utak, start).\n"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a scenario, the episode of its first steps (ep.jsonl), and its decisions (asp)."""
    folder = tmp_path_factory.mktemp("plan")
    (folder / "plug").mkdir()
    for name, text in (("world.txt", WORLD), ("start.lp", START), ("goal.lp", GOAL)):
        (folder / "plug" / name).write_text(text)
    options = ["--max-steps", str(STEPS), "--log", str(folder / "ep.jsonl"), "--dump-asp", str(folder / "asp")]
    assert main(["run", str(folder / "plug"), *options]) == 75
    return folder


@pytest.fixture(scope="module")
def first(run: Path) -> int:
    """Return the first step at which a plan attains all goals: the robot has felt by then what o1 and o2 are."""
    stated = (set(line["belief"]["facts"]) for line in read_episode(run / "ep.jsonl").steps)
    return next(step for step, facts in enumerate(stated) if any(fact.startswith("price(") for fact in facts))


def printed(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    """Return what a command prints."""
    capsys.readouterr()
    assert main(list(arguments)) == code
    return capsys.readouterr().out


def test_the_block_is_planned_to_be_moved_aside_and_then_the_plan_goes_on(
    run: Path, first: int, capsys: pytest.CaptureFixture[str]
) -> None:
    told = json.loads(printed(capsys, "plan", str(run / "ep.jsonl"), "--at", str(first), "--json"))
    assert accepts("plan", told)
    plan = told["plan"]
    assert [step["step"] for step in plan["steps"]][1:] == ["carry(o1,g1_r2)", "arrive(g2_r1)"]
    assert plan["steps"][0]["step"].startswith("clear(o2,spot")
    assert [step["serves"] for step in plan["steps"]] == [[], ["g1"], ["g2"]]
    assert all(step["certainty"] == "verified" for step in plan["steps"])
    assert sum(step["commands"] for step in plan["steps"]) == plan["cost"] >= plan["least"]
    assert plan["gap"] == plan["cost"] - plan["least"]
    assert [goal["means"] for goal in plan["goals"]] == [["in(x,room(next))"], ["at(utak,start)"]]
    assert {"at(o1,here)", "at(o2,here)"} <= set(plan["refuted"][0]["given"])
    assert plan["refuted"][0]["step"] == "carry(o1,g1_r2)"
    last = json.loads(printed(capsys, "plan", str(run / "ep.jsonl"), "--json"))
    assert last["step"] == STEPS
    assert [step["step"] for step in last["plan"]["steps"]] == ["carry(o1,g1_r2)", "arrive(g2_r1)"]


def test_the_plan_of_a_scenario_is_the_first_one_of_its_run(
    run: Path, first: int, capsys: pytest.CaptureFixture[str]
) -> None:
    of_the_run = printed(capsys, "plan", str(run / "ep.jsonl"), "--at", str(first))
    assert printed(capsys, "plan", str(run / "plug")) == of_the_run


def test_before_the_object_is_found_the_plan_is_to_find_it(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plan", str(run / "ep.jsonl"), "--at", "0", "--json"]) == 1
    said = capsys.readouterr()
    assert "step 0 has no plan that attains all goals" in said.err
    found = json.loads(said.out)
    assert accepts("plan", found)
    assert (found["plan"]["found"], found["plan"]["cost"]) == (False, None)
    assert [step["step"] for step in found["plan"]["steps"]] == ["find(g1)", "arrive(g2_r1)"]
    assert [goal["attained"] for goal in found["plan"]["goals"]] == [False, True]
    questions = questions_of_episode(read_episode(run / "ep.jsonl"))
    assert "occurs(find(g1),0)" in {reason.claim for reason in questions.why("plan(0, S)", 0).walk()}


def test_a_step_without_a_plan_is_said_to_have_none(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, text in (("world.txt", WORLD), ("start.lp", START), ("goal.lp", "circled(utak, x).")):
        (tmp_path / name).write_text(text)
    assert main(["plan", str(tmp_path), "--at", "0", "--json"]) == 1
    said = capsys.readouterr()
    plan = json.loads(said.out)["plan"]
    assert (plan["found"], [step["step"] for step in plan["steps"]]) == (False, ["pursue(robot)"])
    assert [step["step"].partition("(")[0] for step in plan["robot"]] == ["go", "look"]
    assert "step 0 has no plan that attains all goals\n" in said.err
    assert main(["plan", str(run / "ep.jsonl"), "--at", "99"]) == 65


@pytest.mark.parametrize(
    ("query", "answer"),
    [
        ("plan(I, arrive(P))", [[2, "g2_r1"]]),
        (
            "means(G, in(X, room(next))), bound(X, N), plan(I, carry(N, P)), serves(I, G)",
            [["g1", "x", "o1", 1, "g1_r2"]],
        ),
        ("means(G, at(utak, start))", [["g2"]]),
        ("means(G, F), F = at(utak, P)", [["g2", "at(utak,start)", "start"]]),
        ("passes(I, D), connects(D, r1, r2, _), not plan(I, arrive(_))", [[1, "d1"]]),
        ("refuted(carry(o1, P), N), given(N, at(o2, Q))", [["g1_r2", 0, "here"]]),
    ],
)
def test_queries_join_the_plan_with_the_world(
    run: Path, first: int, capsys: pytest.CaptureFixture[str], query: str, answer: list[Any]
) -> None:
    found = json.loads(printed(capsys, "query", str(run / "ep.jsonl"), query, "--at", str(first), "--json"))
    assert found["rows"] == answer


@pytest.mark.parametrize("query", ["plan(7, S)", "plan(I, carry(o2, P))", "goal(G), not means(G, _)", "unmet(G)"])
def test_what_is_not_planned_is_known_not_to_be(
    run: Path, first: int, capsys: pytest.CaptureFixture[str], query: str
) -> None:
    assert printed(capsys, "query", str(run / "ep.jsonl"), query, "--at", str(first)) == "no\n"


def test_every_fact_and_command_of_the_plan_is_explained(run: Path, first: int) -> None:
    episode = read_episode(run / "ep.jsonl")
    questions, lines = questions_of_episode(episode), list(episode.steps)
    names = ("goal(", "means(", "plan(", "serves(", "passes(", "takes(", "verified(", "price(", "refuted(", "given(")
    asked = [(fact, line["step"]) for line in lines for fact in line["belief"]["facts"] if fact.startswith(names)]
    assert {fact.partition("(")[0] + "(" for fact, _ in asked} == set(names)
    for fact, step in asked:
        assert list(complaints(lines, questions.why(fact, step).as_dict())) == [], (fact, step)
    for step in range(1, len(lines)):
        assert list(complaints(lines, questions.why_step(step).as_dict())) == []
    claims = [reason.claim for reason in questions.why_step(first + 1).walk()]
    aside = next(claim for claim in claims if claim.startswith("plan(0,clear(o2,"))
    assert f"occurs({aside[len('plan(0,') : -1]},0)" in claims
    assert {"refuted(carry(o1,g1_r2),0)", "given(0,at(o2,here))", "means(g1,in(x,room(next)))"} <= set(claims)


def test_what_a_step_takes_is_cited_from_where_the_step_has_that_number(run: Path, first: int) -> None:
    """When the first step is done, the second one is the present one, and what was said of 1 is said of 0."""
    episode = read_episode(run / "ep.jsonl")
    questions, cited = questions_of_episode(episode), set()
    for step in range(first, STEPS + 1):
        for node in questions.why("plan(0, S)", step).walk():
            if node.claim.startswith(("takes(", "verified(")):
                number = node.claim.partition("(")[2].partition(",")[0].removesuffix(")")
                planned = [
                    [fact for fact in episode.steps[at]["belief"]["facts"] if fact.startswith(f"plan({number},")]
                    for at in (step, int(node.source.removeprefix("step ")))
                ]
                assert planned[0] == planned[1] != []
                cited.add(planned[0][0])
    assert len(cited) == 2


def test_why_not_knows_what_a_plan_is(run: Path, first: int) -> None:
    """Its facts are neither seen nor measured: the plan states them or does not."""
    questions = questions_of_episode(read_episode(run / "ep.jsonl"))
    for fact in ("goal(g7)", "passes(0,d9)", "refuted(arrive(here),9)"):
        assert questions.why_not(fact, first).because.startswith("the task plan does not state it")
    assert questions.why_not("unmet(g1)", first).because == "the task plan does not state it"
    assert questions.why("unmet(g1)", 0).rests_on[0].claim.startswith("the command was ")  # that settles what is open
    cost = questions.why("price(K, L, E)", first).because
    assert cost.startswith("about 10 commands for the whole plan; lower bound by the estimates of the search ")
    assert cost.endswith("; the search ended with it")
    assert questions.why_not("held(o1)", 4).because == "it was never in hand up to this step; this is in hand instead"


@pytest.mark.long
def test_another_first_step_is_said_to_cost_more(run: Path, first: int) -> None:
    questions = questions_of_episode(read_episode(run / "ep.jsonl"))
    reason = questions.why_not("plan(0,arrive(g2_r1))", first)
    assert any("costs" in below.because for below in reason.rests_on)


def test_plain_clingo_gives_the_same_plan(run: Path) -> None:
    entries = [json.loads(line) for line in (run / "asp" / "index.jsonl").read_text().splitlines()]
    entry = next(entry for entry in entries if entry["encoding"] == "task")
    control = clingo.Control(["--warn=none"])
    control.load(str(run / "asp" / entry["file"]))
    control.ground([("base", [])])
    with control.solve(yield_=True) as models:
        answers = [(model.cost, sorted(map(str, model.symbols(shown=True)))) for model in models]
    assert answers[-1][1] == entry["answer"]
    facts = read_episode(run / "ep.jsonl").steps[entry["step"]]["belief"]["facts"]
    planned = {fact[len("plan(0,") : -len(").")] for fact in facts if fact.startswith("plan(0,")}
    assert {f"occurs({step},0)" for step in planned} <= set(entry["answer"])


def test_text_replay_tells_a_plan_once_and_then_its_present_step(run: Path, first: int) -> None:
    texts = list(transcript("ep.jsonl", read_episode(run / "ep.jsonl")))
    assert not any("clear(" in text for text in texts[:first])
    assert "\n> 0 clear(o2," in texts[first]
    assert "\n  1 carry(o1,g1_r2): " in texts[first]
    assert "\nplan as before: > 0 clear(o2," in texts[first + 1]
    assert "\n> 0 carry(o1,g1_r2): " in texts[STEPS]


@pytest.mark.long
def test_the_prompt_tells_the_plan_that_the_command_tells(
    run: Path, first: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    told = printed(capsys, "plan", str(run / "ep.jsonl"), "--at", str(first)).splitlines()
    typed = f"goto {first}\nplan\nplan(0, S).\nhelp plan\n".encode()
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(typed)))
    said = printed(capsys, "repl", str(run / "ep.jsonl"))
    assert "planned:\n" + "".join(f"  {line}\n" for line in told[1:]) + "next: " in said
    assert "\nS\nclear(o2,spot" in said
    assert "> marks the present step" in said


def test_a_run_in_python_shows_its_plan(first: int) -> None:
    now = utak.Run(utak.Scenario.from_text(world=WORLD, start=START, goal=GOAL))
    assert now.plan.task is not None and not now.plan.task.found
    for _ in range(first):
        now.step()
    plan = now.plan
    assert plan.task is not None and plan.task.found
    assert [f"plan({step.number},{step.step})" for step in plan.task.steps] == sorted(plan.steps)
    assert str(plan).splitlines()[1:] == list(plan.task.lines())
    assert repr(plan) == str(plan)
    assert plan._repr_html_().count("<tr>") == 1 + len(plan.steps)


@pytest.mark.long
def test_where_no_plan_was_found_the_unmet_goal_and_what_was_refuted_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = WORLD.splitlines()
    rows[4], rows[6] = (row[:12] + "b" + row[13:] for row in (rows[4], rows[6]))
    rows[4] = rows[4].replace("gg", "..")
    rows[5] = rows[5].replace("gg", "..")
    for name, text in (("world.txt", "\n".join(rows)), ("start.lp", START), ("goal.lp", GOAL)):
        (tmp_path / name).write_text(text)
    log = tmp_path / "ep.jsonl"
    assert main(["run", str(tmp_path), "--max-steps", "3", "--log", str(log)]) == 75
    found = json.loads(printed(capsys, "plan", str(log), "--json", code=1))
    assert accepts("plan", found)
    assert found["plan"]["found"] is False and not any("carry" in one["step"] for one in found["plan"]["steps"])
    assert [goal["name"] for goal in found["plan"]["goals"] if not goal["attained"]] == ["g1"]
    assert {one["step"] for one in found["plan"]["refuted"]} == {"carry(o1,g1_r2)"}
    questions = questions_of_episode(read_episode(log))
    assert "unmet(g1)" in {reason.claim for reason in questions.why("verdict(V)").walk()}


def damaged(episode: Episode, fact: str) -> Episode:
    """Return an episode whose last step states one more fact."""
    last = episode.steps[-1]
    belief = {**last["belief"], "facts": [*last["belief"]["facts"], fact]}
    return Episode(episode.header, (*episode.steps[:-1], {**last, "belief": belief}), episode.result)


@pytest.mark.parametrize("fact", ["plan(x,y).", "refuted(o1,0).", 'price("1",2,proved).'])
def test_a_damaged_plan_is_bad_input(run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], fact: str) -> None:
    episode, path = damaged(read_episode(run / "ep.jsonl"), fact), tmp_path / "ep.jsonl"
    path.write_text("".join(encode(line) for line in (episode.header, *episode.steps)))
    assert main(["plan", str(path)]) == 65
    said = capsys.readouterr()
    assert said.out == ""
    assert f"ep.jsonl:{STEPS + 2}:" in said.err
    assert "damaged" in said.err
    assert "the facts of the plan are damaged" in "".join(transcript("ep.jsonl", episode))
