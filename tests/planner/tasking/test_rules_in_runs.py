"""Rules of users in whole runs, and in decisions about what settles something: what they say is what is done."""

import re
from pathlib import Path

import pytest
import shapely

import utak
from utak.kb.language.diagnostics import BadInputError
from utak.kb.reasoning.user_rules import read_rules
from utak.planner.tasking.proposal import propose

TWO_SQUARES = (
    """table(46, 28).
verge("POLYGON ((0 0, 0 28, 46 28, 46 0, 0 0), (23 2, 23 17, 25 17, 25 2, 44 2, 44 26, 25 26, 25 23, 23 23, 23 26, """
    """2 26, 2 2, 23 2))").
utak("POINT (13.5 6.5)", 90).
object(t1, c, "POLYGON ((21 8, 18 8, 18 11, 21 11, 21 8))").
object(t2, d, "POLYGON ((12 20, 12 23, 15 23, 15 20, 12 20))").
"""
)


EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
EXCHANGE, PLACES = "push_exchange_rooms", "push_exchange_places"


def documented(number: str) -> Path:
    """Return the path of a rule of docs/rules, by its number."""
    (found,) = (EXAMPLES.parent / "docs" / "rules").glob(f"{number}_*.lp")
    return found


def rule_file(folder: Path, text: str) -> Path:
    """Return the path of a new file with rules."""
    path = folder / "own.lp"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.long
def test_a_meaning_that_a_rule_refuses_makes_the_next_thing_meant(tmp_path: Path) -> None:
    """x is no thing of colour c: the run ends with the other one in the next room."""
    expected = 'inside(t2, "POLYGON ((44 2, 44 26, 25 26, 25 2, 44 2))"). unmoved(t1).'
    scenario = utak.Scenario.from_text(
        world=TWO_SQUARES, start="object(x). shape(x, square).", goal="in(x, room(next)).", expect=expected
    )
    rules = rule_file(tmp_path, ":- meaning(x, X), colour(X, c, _).")
    episode = utak.Run(scenario, rules=[rules]).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)


def test_a_price_that_a_rule_states_replaces_the_default(tmp_path: Path) -> None:
    """Feeling counts for 10 commands, and pulling for less; with a price of 1 feeling comes first."""
    facts = ("horizon(1)", "goal(g1)", "stuck(g1,impossible)")
    steps = [str(errand) for errand in propose(facts, ()).errands]
    assert steps != ["feel(g1)"]
    cheap = rule_file(tmp_path, "price(feel(S), 1) :- stuck(S, impossible).")
    assert [str(errand) for errand in propose(facts, (cheap,)).errands] == ["feel(g1)"]


@pytest.mark.parametrize("spoilt", ["missing(g1)", "any_way", "shaken"])
def test_before_a_goal_is_given_up_with_nothing_proved_things_are_felt_all_round(spoilt: str) -> None:
    facts = ("horizon(1)", "goal(g1)", "stuck(g1,limit)")
    assert "try(g1)" in propose(facts, ()).left
    assert "try(g1)" not in propose((*facts, spoilt), ()).left


@pytest.mark.parametrize(
    ("rule", "hint"),
    [
        (":- occurs(goto(D), T), width(D, W), W < 500.", "did you mean go?"),
        (":- occurs(go(D, R), T), connects(D, R, _).", "there is go/1"),
        (":- do(fel(S)), stuck(S, impossible).", "did you mean feel?"),
        (":- not occurs(cary(X, P), 0), place(X, P).", "did you mean carry?"),
        (":- occurs(carry(x, P), T).", "write meaning(x, X)"),
        (":- brought(x, _, _, T).", "write meaning(x, X)"),
        (":- brought(X, _, _, T), in(X, hall).", "such as r1"),
        (":- brought(X, _, _, T), colour(X, green, _).", "a single lower-case letter"),
        (":- not shape(X, sqare, 100), brought(X, _, _, T).", "did you mean square?"),
    ],
)
def test_what_is_never_so_in_a_body_is_refused(tmp_path: Path, rule: str, hint: str) -> None:
    """A rule about a step or a name that does not exist never applies: an error, with what may have been meant."""
    with pytest.raises(BadInputError) as caught:
        read_rules([rule_file(tmp_path, rule)])
    (problem,) = caught.value.problems
    assert hint in f"{problem.what}; {problem.hint}"


@pytest.mark.long
def test_the_robot_passes_the_other_door_where_a_rule_closes_one_by_name(tmp_path: Path) -> None:
    """A door has its name before the wall beside it was felt, and keeps it: the rule about d1 counts from then on."""
    rules = rule_file(tmp_path, ":- occurs(go(d1), T).")
    episode = utak.Run(utak.Scenario.read(EXAMPLES / "go_next_room_two_doors"), rules=[rules]).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)
    assert all(step.utak[1] < 13 for step in episode if 22 <= step.utak[0] <= 25)  # d1 is the door in the north


def test_what_settles_a_goal_by_a_rule_is_done_once_the_robot_is_stuck(tmp_path: Path) -> None:
    """The rule is met by no plan before; then its step is planned, and the reasons name the rule."""
    text = "settles(feel(G), G) :- goal(G). :- goal(G), occurs(carry(X,P),T), not settled(G, T)."
    rules = rule_file(tmp_path, text)
    facts = ("horizon(2)", "goal(g1)", "thing(o1)", "place(o1, here)", "place(o1, g1_p)", "fulfils(o1, g1_p, g1)")
    assert propose(facts, [rules]).errands == ()
    assert [str(errand) for errand in propose((*facts, "stuck(plan, limit)"), [rules]).errands] == ["feel(g1)"]
    episode = utak.Run(utak.Scenario.read(EXAMPLES / "push_square_next_room"), rules=[rules], max_steps=3).finish()
    said = episode.why("plan(0, feel(g1))", step=2).text("long")
    assert re.search(r"came_to\(pursue\(g1\),limit\): .* the rule at .*own.lp:1 leaves no plan", said)


@pytest.mark.long
def test_the_step_that_settles_something_is_the_plan_that_is_shown(tmp_path: Path) -> None:
    """In a room without doors walls are felt, which a rule makes cheap: the plan of that step says so."""
    world = """table(12, 12). verge("POLYGON ((0 0, 0 12, 12 12, 12 0, 0 0), (10 10, 2 10, 2 2, 10 2, 10 10))").
utak("POINT (6.5 6.5)", 90)."""
    scenario = utak.Scenario.from_text(world=world, start="", goal="in(utak, room(next)).")
    rules = rule_file(tmp_path, "price(feel(S), 1) :- stuck(S, impossible).")
    episode = utak.Run(scenario, rules=[rules], max_steps=12).finish()
    plans = [fact for step in episode for fact in step.line["belief"]["facts"] if fact.startswith("plan(0,")]
    assert list(dict.fromkeys(plans))[:2] == ["plan(0,pursue(robot)).", "plan(0,feel(robot))."]


@pytest.mark.long
def test_a_priced_door_is_not_passed_while_the_robot_looks_about() -> None:
    """Of two doors the narrow one has a price: neither the robot nor what it carries goes through."""
    world = (
        """table(27, 39).
verge("MULTIPOLYGON (((0 0, 0 39, 27 39, 27 0, 0 0), (21.3 20.5, 21.3 21.5, 25.55 21.5, 25.55 37.75, 2.25 37.75, """
        """2.25 21.5, 6.25 21.5, 6.25 20.5, 2.25 20.5, 2.25 2.25, 25.55 2.25, 25.55 20.5, 21.3 20.5)), """
        """((17.9 20.5, 12.65 20.5, 12.65 21.5, 17.9 21.5, 17.9 20.5)))").
utak("POINT (16.5 12.5)", 0).
object(t1, t, "POLYGON ((6 9, 6 11, 8 11, 8 9, 6 9))").
"""
    )
    narrow = '"POLYGON ((17.9 20.6, 21.3 20.6, 21.3 21.4, 17.9 21.4, 17.9 20.6))"'
    expected = f"avoids(utak, {narrow}). avoids(t1, {narrow})."
    scenario = utak.Scenario.from_text(
        world=world, start="object(x). shape(x, square).", goal="in(x, room(next)).", expect=expected
    )
    episode = utak.Run(scenario, rules=[documented("10")]).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)


@pytest.mark.long
def test_a_door_that_is_surely_narrow_is_not_passed_where_another_may_be_wide_enough() -> None:
    """The narrow door is the nearer one; the other, 5.6 wide, leaves 4 whole squares and is believed to be narrow."""
    world = """table(46, 27).
verge("MULTIPOLYGON (((0 0, 0 27, 46 27, 46 0, 0 0), (23.38 8.38, 24.38 8.38, 24.38 2.69, 44.07 2.69, 44.07 25.17, \
24.38 25.17, 24.38 21.17, 23.38 21.17, 23.38 25.17, 2.69 25.17, 2.69 2.69, 23.38 2.69, 23.38 8.38)), \
((23.38 13.98, 23.38 17.67, 24.38 17.67, 24.38 13.98, 23.38 13.98)))").
utak("POINT (32.5 19.5)", 215).
"""
    scenario = utak.Scenario.from_text(world=world, start="", goal="in(utak, room(next)).")
    episode = utak.Run(scenario, rules=[documented("10")]).finish()
    track = shapely.LineString([step.utak for step in episode])
    assert episode.verdict == "done" and not track.crosses(shapely.LineString([(23.9, 17.6), (23.9, 21.2)]))


FINAL = """%! because "At the end nothing that can be carried is left in room r1."
:- horizon(H), at(X, P, H), lies(X, P, r1), thing(X).
"""
SQUARE = {"start": "object(x). shape(x, square).", "goal": "in(x, room(next))."}


def test_a_rule_about_the_end_does_not_keep_the_robot_from_looking_for_what_is_meant(tmp_path: Path) -> None:
    """While a goal's object is not found, no plan is the end: what the end shall be forbids no search."""
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, **SQUARE)
    run = utak.Run(scenario, rules=[rule_file(tmp_path, FINAL)])
    run.step()
    assert run.verdict is None


@pytest.mark.long
def test_the_end_of_a_run_names_rules_that_never_applied(tmp_path: Path) -> None:
    """One rule is about a door that is wide enough, one about a colour that nothing has, one applies."""
    rules = rule_file(
        tmp_path,
        ":- occurs(go(D), T), width(D, W), W < 100.\n:- occurs(carry(X, P), T), colour(X, q, _).\n"
        ":~ occurs(carry(X, P), T). [1@0, X]\nred(X) :- colour(X, r, _).\nbig(X) :- object(X), not held(X).\n",
    )
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, **SQUARE)
    episode = utak.Run(scenario, rules=[rules]).finish()
    assert episode.verdict == "done"
    assert [one.split(" ")[0] for one in episode.idle_rules] == [f"{rules}:{line}:" for line in (1, 2, 4)]
    assert (
        utak.Run(scenario, rules=[rule_file(tmp_path, ":~ occurs(carry(X, P), T). [1@0, X]")]).finish().idle_rules == ()
    )


def test_rules_say_what_shape_things_have(tmp_path: Path) -> None:
    """What a rule states of a shape counts in what is believed, be it more or less than what is seen."""
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, **SQUARE)
    for stated in (99, 3):
        rules = rule_file(tmp_path, f"shape(N, square, {stated}) :- fit(N, square, _, _).")
        world = utak.Run(scenario, rules=[rules]).world
        assert {row["C"] for row in world.query("shape(X, square, C)")} == {stated}


@pytest.mark.long
@pytest.mark.parametrize(
    ("rule", "blamed"),
    [
        (":- link(L, J, K, N, C), N > 0.", True),
        (":- unseen(R, N), N > 10.", True),
        (":- in(utak, R), adjacent(org, X), held(X).", False),
        (":- room(R), not door(d9), node(floor).", True),
        ("far(X) :- offset(X, E, N), object(X), E > 10000. :- occurs(carry(X, P), T), far(X).", False),
    ],
)
def test_facts_of_the_world_model_are_known_to_the_task_plan(tmp_path: Path, rule: str, blamed: bool) -> None:
    """A rule about nothing but the world leaves no plan where it holds, and the verdict names it."""
    scenario = utak.Scenario.from_text(world=TWO_SQUARES, start="", goal="in(utak, room(next)).")
    rules = rule_file(tmp_path, rule)
    episode = utak.Run(scenario, rules=[rules], max_steps=12).finish()
    assert (episode.verdict != "done") is blamed
    assert episode.verdict != "impossible"  # what is believed may change
    assert (f"{rules}:1" in episode.reason) is blamed


Y_AWAY_FIRST = ":- brought(X, _, _, T), meaning(x, X), meaning(y, Y), at(Y, here, T)."
X_AFTER_Y = ":- brought(X, _, _, T), meaning(x, X), meaning(y, Y), not brought(Y, _, _, T-1)."


def moves_of(episode: utak.Episode, name: str) -> list[int]:
    """Return the numbers of the steps at which a thing lay elsewhere than the step before."""
    shapes = [step.line["objects"][name] for step in episode]
    return [number for number in range(1, len(shapes)) if shapes[number] != shapes[number - 1]]


PASTS = [(EXCHANGE, Y_AWAY_FIRST), (EXCHANGE, X_AFTER_Y), (PLACES, Y_AWAY_FIRST)]


@pytest.mark.long
@pytest.mark.parametrize(("example", "rule"), PASTS)
def test_what_was_done_is_the_past_of_a_plan_made_anew(tmp_path: Path, example: str, rule: str) -> None:
    """The plan is made anew once y was brought; it lies no longer where it was, and its errand counts."""
    scenario = utak.Scenario.read(EXAMPLES / example)
    episode = utak.Run(scenario, rules=[rule_file(tmp_path, rule)]).finish()
    assert (episode.verdict, episode.achieved) == ("done", True)
    assert min(moves_of(episode, "r1")) < min(moves_of(episode, "g1"))  # x is not touched before y is away


@pytest.mark.long
def test_a_number_of_errands_counts_over_the_whole_run(tmp_path: Path) -> None:
    """Two things must be brought, and only one errand is allowed: one is not brought and then forgotten."""
    rules = rule_file(tmp_path, ":- #count { X, T : brought(X, _, _, T), X != utak } > 1.")
    episode = utak.Run(utak.Scenario.read(EXAMPLES / EXCHANGE), rules=[rules]).finish()
    assert episode.verdict != "done" and f"{rules}:1" in episode.reason


@pytest.mark.long
def test_what_is_in_hand_is_put_down_where_a_rule_leaves_no_plan_any_more(tmp_path: Path) -> None:
    """From the door more is seen of the next room, of which more is unseen then than the rule allows."""
    rules = rule_file(tmp_path, ":- brought(X, _, _, _), X != utak, unseen(R, N), N > 160.")
    scenario = utak.Scenario.read(EXAMPLES / "push_square_next_room")
    episode = utak.Run(scenario, rules=[rules], max_steps=8).finish()
    released = [step.line["why"] for step in episode if step.line["action"] == {"do": "release"}]
    assert released and f"{rules}:1 leaves no plan" in released[0] and episode.verdict != "done"
    assert all(any(x < 24 for x, _ in step.line["objects"]["g1"]) for step in episode)  # never wholly beyond


def test_the_robot_does_not_go_where_a_rule_leaves_it_no_plan(tmp_path: Path) -> None:
    """No door is closed, but no other room may be where the robot goes to."""
    rules = rule_file(tmp_path, ":- occurs(arrive(P), T), lies(utak, P, R), in(utak, Q, C), C >= 50, R != Q.")
    episode = utak.Run(utak.Scenario.read(EXAMPLES / "go_next_room"), rules=[rules]).finish()
    assert episode.verdict == "limit" and f"{rules}:1" in episode.reason
    assert all(step.utak[0] < 21 for step in episode)


@pytest.mark.long
@pytest.mark.parametrize("idle", ["", ":- unseen(R, N), N > 900000.\n"])
def test_an_unrelated_rule_about_the_world_does_not_weaken_a_proof(tmp_path: Path, idle: str) -> None:
    """Two things must be brought and one may be: that is impossible, whatever else another rule speaks of."""
    rules = rule_file(tmp_path, f"{idle}:- #count {{ X : brought(X, _, _, _) }} > 1.")
    episode = utak.Run(utak.Scenario.read(EXAMPLES / EXCHANGE), rules=[rules]).finish()
    assert episode.verdict == "impossible" and f"{rules}:{2 if idle else 1}" in episode.reason


@pytest.mark.long
def test_a_property_that_a_rule_states_counts_for_what_is_meant(tmp_path: Path) -> None:
    """Of a brick and a square the brick's colour makes it a square, and the square is none: the brick is brought."""
    rules = rule_file(
        tmp_path,
        "has(N, shape, square, 99) :- has(N, colour, r, C), C >= 50.\n"
        "has(N, shape, square, 1) :- has(N, colour, K, _), K != r.\n",
    )
    scenario = utak.Scenario.from_text(world=(EXAMPLES / EXCHANGE / "world.lp").read_text(), **SQUARE)
    episode = utak.Run(scenario, rules=[rules], max_steps=40).finish()
    assert moves_of(episode, "g1") == [] and moves_of(episode, "r1")
    assert episode.idle_rules == ()


def middles(episode: utak.Episode, name: str) -> list[tuple[float, float]]:
    """Return where the middle of a thing was at each step, (x, y) in squares, table frame."""
    centres = [shapely.Polygon(step.line["objects"][name]).centroid for step in episode]
    return [(point.x, point.y) for point in centres]


TWO_THINGS = "object(x). shape(x, square). object(y). shape(y, brick)."
KEPT_BRICK = "object(x). shape(x, square). object(keep). shape(keep, brick)."
AT_THE_DOOR = "19 8, 19 14, 21 14, 21 8, 19 8"  # of the brick: the gap beside the wall is 1 wide
BLOCKED, CORNERS = "push_square_blocked_door", "push_two_corners"


def run_with(number: str, example: str, start: str = "", goal: str = "", brick: str = "") -> utak.Episode:
    """Return the run of an example with a rule of docs/rules, and another start, goal or brick where one is given."""
    texts = {name: (EXAMPLES / example / f"{name}.lp").read_text() for name in ("world", "start", "goal")}
    texts |= {name: text for name, text in (("start", start), ("goal", goal)) if text}
    if brick:
        texts["world"] = re.sub(r"(object\(r1, r, ).*\n", rf'\1"POLYGON (({brick}))").\n', texts["world"])
    return utak.Run(utak.Scenario.from_text(**texts), rules=[documented(number)], max_steps=60).finish()


@pytest.mark.long
@pytest.mark.parametrize(("number", "example"), [("02", EXCHANGE), ("03", CORNERS)])
def test_y_is_where_it_shall_be_before_x_is_touched(number: str, example: str) -> None:
    """Without the rule the task's order has x first."""
    episode = run_with(number, example)
    assert episode.verdict == "done"
    assert max(moves_of(episode, "r1")) < min(moves_of(episode, "g1"))


@pytest.mark.long
@pytest.mark.parametrize(("number", "start"), [("04", KEPT_BRICK), ("05", "")])
def test_what_must_not_be_moved_aside_stays_before_the_door(number: str, start: str) -> None:
    """The brick before the only door is the one that is kept, or too large: it stays, and the rule is named."""
    episode = run_with(number, BLOCKED, start, brick=AT_THE_DOOR)
    assert not moves_of(episode, "r1")
    assert episode.verdict != "done" and documented(number).name in episode.reason


@pytest.mark.long
def test_what_is_moved_aside_stays_in_its_room() -> None:
    """The brick before the door is moved aside in its own room, west of the wall."""
    episode = run_with("06", BLOCKED, brick=AT_THE_DOOR)
    assert episode.verdict == "done" and moves_of(episode, "r1")
    assert all(x < 22 for x, _ in middles(episode, "r1"))


@pytest.mark.long
def test_nothing_big_is_brought_into_the_closet() -> None:
    """The square of 25 and the brick of 32 squares stay in the hall, and the rule is named."""
    episode = run_with("07", "push_into_closet")
    assert all(x < 22 for name in ("g1", "r1") for x, _ in middles(episode, name))
    assert episode.verdict != "done" and documented("07").name in episode.reason


@pytest.mark.long
def test_a_goal_of_a_rule_that_cannot_be_planned_is_named() -> None:
    """Where the brick lies the square shall not be; that it is the brick was not seen yet: nothing is touched."""
    episode = run_with("08", EXCHANGE, TWO_THINGS, "in(x, room(next)).")
    assert episode.verdict == "limit" and documented("08").name in episode.reason
    assert not moves_of(episode, "g1") and not moves_of(episode, "r1")


@pytest.mark.long
def test_a_rule_on_what_things_are_proves_nothing_and_is_named(tmp_path: Path) -> None:
    rules = rule_file(tmp_path, "shape(N, square, 1) :- fit(N, square, _, _).")
    episode = utak.Run(utak.Scenario.read(EXAMPLES / EXCHANGE), rules=[rules]).finish()
    assert episode.verdict == "limit"
    assert f"what things are is said by the rule at {rules}:1" in episode.reason
