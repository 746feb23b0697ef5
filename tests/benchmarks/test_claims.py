"""The campaign about claims finds a false done and a false impossible, and accepts true ones."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from shapely import Polygon, box

from benchmarks.claims import __main__ as campaign
from benchmarks.claims import child
from benchmarks.claims.asked import Asked, all_kinds, named, worlds_of, written
from benchmarks.claims.refute import Countersearch, refuted, trespassed
from benchmarks.claims.report import report
from benchmarks.claims.row import ClaimRow, percentile, read_rows
from benchmarks.claims.run import Limits, run_child, run_world
from benchmarks.claims.table import table
from benchmarks.worlds.odd.kinds import odd_world
from benchmarks.worlds.odd.tasks import NO, YES
from tests.scripted import Scripted
from utak.kb.body import Body
from utak.kb.task.task import Task
from utak.planner.cycle import TaskEnd
from utak.simulator.scenario.settings import Settings

LIMITS = Limits(search=5)
ABLE, UNABLE = Asked("plugged", 0), Asked("plugged", 5)


@pytest.fixture
def claiming(tmp_path: Path) -> Callable[[Asked, str], ClaimRow]:
    """Return a function that runs a robot with a verdict in a world."""

    def ran(asked: Asked, verdict: str) -> ClaimRow:
        def make(body: Body, told: Task, settings: Settings) -> Scripted:
            return Scripted(body, [], TaskEnd(verdict == "done", verdict, "so it is"))

        def runner(place: Path, limits: Limits) -> str:
            child.run(place, limits.noise, limits.noise_seed, limits.max_steps, make)
            return "error"

        return run_world(asked, LIMITS, tmp_path, tmp_path / "kept", runner)

    return ran


def test_the_worlds_of_these_tests_can_and_cannot_be_done() -> None:
    assert (odd_world("plugged", ABLE.seed).possible, odd_world("plugged", UNABLE.seed).possible) == (YES, NO)


@pytest.mark.parametrize("asked", [ABLE, UNABLE])
def test_a_planted_false_done_is_found_counted_and_kept(
    claiming: Callable[[Asked, str], ClaimRow], asked: Asked, tmp_path: Path
) -> None:
    row = claiming(asked, "done")
    assert row.false_done and not row.false_impossible and row.refutation
    assert ("the robot ended at" in row.refutation) == (asked == ABLE)
    assert counted([row], "false done") == "1"
    kept = tmp_path / "kept" / asked.name.replace(":", "-")
    assert {"world.lp", "episode.jsonl", "row.json"} <= {path.name for path in kept.iterdir()}
    assert f"`{asked.name}`" in report([row]).split("## Errors")[0]


@pytest.mark.long
def test_a_planted_false_impossible_is_found_and_a_true_one_is_not(claiming: Callable[[Asked, str], ClaimRow]) -> None:
    false, true = claiming(ABLE, "impossible"), claiming(UNABLE, "impossible")
    assert (false.false_impossible, true.false_impossible) == (True, False)
    assert "can be done" in false.refutation and not true.refutation
    assert counted([false, true], "false impossible") == "1"
    assert counted([false, true], "impossible") == "2"


@pytest.mark.long
@pytest.mark.parametrize("verdict", ["limit", "possible_if", "whatever"])
def test_other_verdicts_claim_nothing_and_have_their_columns(
    claiming: Callable[[Asked, str], ClaimRow], verdict: str
) -> None:
    row = claiming(ABLE, verdict)
    assert not row.faulty
    assert counted([row], verdict) == "1"


def counted(rows: list[ClaimRow], column: str) -> str:
    """Return the value of a column in the last line of the table; its head is split at two blanks or more."""
    lines = [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in table(rows).splitlines()]
    return lines[-1][lines[0].index(column)]


def test_a_found_plan_refutes_an_impossible_claim() -> None:
    found, none = Countersearch("solvable", "move 1 0"), Countersearch("not found")
    assert refuted("impossible", False, False, [], "unknown", found).false_impossible
    assert not refuted("impossible", False, False, [], "unknown", none).false_impossible
    assert refuted("impossible", False, False, [], "yes", none).false_impossible
    assert "move 1 0" in refuted("impossible", False, False, [], "unknown", found).refutation
    assert not refuted("done", True, True, [], "yes", none).false_done
    assert "inside(t1)" in refuted("done", True, False, ["inside(t1)"], "yes", none).refutation


def test_a_task_with_a_violated_constraint_is_not_done(tmp_path: Path) -> None:
    episode = tmp_path / "episode.jsonl"
    episode.write_text("".join(json.dumps({"step": n, "utak": [x, 1.0]}) + "\n" for n, x in enumerate((1.0, 9.0, 1.0))))
    assert trespassed(episode, box(4, 0, 6, 2))
    assert not trespassed(episode, box(4, 2, 6, 4)) and not trespassed(episode, Polygon())
    shut = [odd_world("constraint", seed) for seed in range(13) if not odd_world("constraint", seed).avoid.is_empty]
    assert {world.variant for world in shut} == {"walk_one_door", "walk_at_home", "carry_on_foot"}
    assert not any(world.avoid.intersects(world.utak) for world in shut)


def test_a_child_that_breaks_is_an_error(tmp_path: Path) -> None:
    written(ABLE, tmp_path)
    assert run_child(tmp_path, Limits(megabytes=60)) == "error"


def test_a_run_out_of_time_tells_how_long_its_last_command_took(tmp_path: Path) -> None:
    def runner(place: Path, limits: Limits) -> str:
        (place / child.CYCLES_FILE).write_text("1.0\n2.0\n")
        (place / "stderr.txt").write_text("")
        return "time"

    row = run_world(ABLE, Limits(seconds=100), tmp_path, None, runner)
    assert (row.verdict, row.commands, row.cycles, row.faulty) == ("time", 1, [2.0, 97.0], True)


def test_a_campaign_continues_earlier_results(claiming: Callable[[Asked, str], ClaimRow], tmp_path: Path) -> None:
    rows = [claiming(ABLE, "limit")]
    results = tmp_path / "results.jsonl"
    results.write_text(rows[0].line() + "\n" + '{"kind": "plu')
    assert read_rows(results) == rows
    assert {"longest", "percentile_95"} <= set(json.loads(results.read_text().splitlines()[0]))
    results.write_text(rows[0].line() + "\n")
    asked: list[Asked] = []

    def run_all(worlds: list[Asked], *rest: object) -> Iterator[ClaimRow]:
        asked.extend(worlds)
        return iter(())

    assert campaign.main(["--kind", "plugged", "--count", "2", "-o", str(results)], run_all) == 0
    assert asked == [Asked("plugged", 1)]


def test_worlds_by_name_and_in_turn() -> None:
    assert [named(Asked("plugged", 3).name), named("own_wide:9:4")] == [Asked("plugged", 3), Asked("own_wide", 4, 9)]
    with pytest.raises(ValueError, match="say KIND:SEED"):
        named("own_wide:9")
    assert worlds_of(["round", "own_loose"], 2, 1) == [
        Asked("round", 2),
        *(Asked("own_loose", 2, t) for t in range(5, 10)),
    ]
    assert "own_snug" in all_kinds()


def test_the_percentile_of_seconds() -> None:
    assert percentile([]) == 0
    assert percentile([float(n) for n in range(100)]) == 95
