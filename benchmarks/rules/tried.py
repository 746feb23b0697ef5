"""The rules that are tried, each with how the true track of a run shows that it was kept."""

from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.rules.track import WALL_AT, TrueTrack


@dataclass(frozen=True)
class Tried:
    """A rule that is tried.

    Attributes
    ----------
    kind : what it is about.
    text : the rule.
    kept : whether the rule was kept, by what truly happened; None for a rule that is to be refused.
    examples : the scenarios in which it is tried.
    refused : what the message of the refusal says; "" for a rule that counts.
    said : what the verdict's reason may say in place of the rule's name, where the rule is about what is believed; ""
        where it must name the rule.
    """

    kind: str
    text: str
    kept: Callable[[TrueTrack], bool] | None = None
    examples: tuple[str, ...] = ()
    refused: str = ""
    said: str = ""


GO, TWO_DOORS, SQUARE, EXCHANGE, BOTH_CORNERS, SWAPPED_PLACES, WITHOUT_DOOR, NARROW_DOOR = WALL_AT
WALKS, CARRIES, BRING_TWO = (GO, TWO_DOORS), (SQUARE, EXCHANGE), (EXCHANGE, BOTH_CORNERS)
PLACED_AT_GOAL = "placed(X, T) :- at(X, P, T), fulfils(X, P, _)."
STUCK_STEPS = ("pull", "make_way", "try", "feel", "bare")  # what may settle that something seems impossible
TRIED_RULES: dict[str, Tried] = {
    "no_door": Tried("doors", ":- occurs(go(D), T).", lambda t: not t.passes(), (GO, SQUARE)),
    "no_narrow": Tried(
        "doors",
        ":- occurs(go(D), T), width(D, W), W < 450.",
        lambda t: bool(t.passes()) == (t.wall == WALL_AT[TWO_DOORS]),
        WALKS,
    ),
    "no_wide": Tried(
        "doors",
        ":- occurs(go(D), T), width(D, W), W > 450.",
        lambda t: bool(t.passes()) == (t.wall == WALL_AT[GO]),
        WALKS,
    ),
    "no_first_door": Tried("doors", ":- occurs(go(d1), T).", lambda t: not t.passes_where("d1"), (TWO_DOORS, SQUARE)),
    "nothing_through": Tried(
        "doors",
        ":- occurs(go(D), T), brought(X, _, _, T), X != utak.",
        lambda t: not any(t.passes(name) for name in t.things),
        CARRIES,
    ),
    "y_first": Tried(
        "orders",
        f"{PLACED_AT_GOAL} :- brought(X, _, _, T), meaning(x, X), meaning(y, Y), not placed(Y, T).",
        lambda t: t.moved()[:1] != ["g1"],
        BRING_TWO,
    ),
    "x_first": Tried(
        "orders",
        f"{PLACED_AT_GOAL} :- brought(Y, _, _, T), meaning(x, X), meaning(y, Y), not placed(X, T).",
        lambda t: t.moved()[:1] != ["r1"],
        BRING_TWO,
    ),
    "y_away_first": Tried(
        "orders",
        ":- brought(X, _, _, T), meaning(x, X), meaning(y, Y), at(Y, here, T).",
        lambda t: t.moved() == ["r1", "g1"],
        (EXCHANGE, BOTH_CORNERS, SWAPPED_PLACES),
    ),
    "x_right_after_y": Tried(
        "orders",
        ":- brought(X, _, _, T), meaning(x, X), meaning(y, Y), not brought(Y, _, _, T-1).",
        lambda t: t.moved() == ["r1", "g1"],
        BRING_TWO,
    ),
    "one_thing": Tried(
        "counts", ":- #count { X, T : brought(X, _, _, T), X != utak } > 1.", lambda t: len(t.moved()) <= 1, CARRIES
    ),
    "one_pass": Tried("counts", ":- #count { D, T : occurs(go(D), T) } > 1.", lambda t: len(t.passes()) <= 1, CARRIES),
    "no_carry": Tried("counts", ":- brought(X, _, _, _), X != utak.", lambda t: not t.moved(), CARRIES),
    "dear_doors": Tried("prices", ":~ occurs(go(D), T). [9@1, D, T]", lambda t: len(t.passes()) == 1, (GO, SQUARE)),
    "cheap_feeling": Tried(
        "prices",
        "price(feel(S), 1) :- stuck(S, impossible).",
        lambda t: t.first_planned(STUCK_STEPS) == "feel",
        (WITHOUT_DOOR, NARROW_DOOR),
        said="cannot be attained",
    ),
    "apart": Tried(
        "end states",
        ":- horizon(H), at(X, P, H), at(Y, Q, H), X < Y, lies(X, P, R), lies(Y, Q, R).",
        lambda t: t.ends_east("g1") != t.ends_east("r1"),
        CARRIES,
    ),
    "together": Tried(
        "end states",
        ":- horizon(H), at(X, P, H), at(Y, Q, H), X < Y, lies(X, P, R), lies(Y, Q, S), R != S.",
        lambda t: t.ends_east("g1") == t.ends_east("r1"),
        CARRIES,
    ),
    "not_what_is_square": Tried(
        "meanings",
        "shape(N, square, 1) :- fit(N, square, _, _).",
        lambda t: not t.ends_east("g1"),
        CARRIES,
    ),
    "red_are_squares": Tried(
        "meanings",
        "has(N, shape, square, 99) :- has(N, colour, r, _). has(N, shape, square, 1) :- has(N, colour, K, _), K != r.",
        lambda t: not t.ends_east("g1"),  # it may be moved to measure it: it might be y
        CARRIES,
    ),
    "x_is_not_large": Tried(
        "meanings", ":- meaning(x, X), size(X, S), S > 8.", lambda t: "g1" not in t.moved(), CARRIES
    ),
    "large_stays": Tried(
        "own predicates",
        "big(X) :- size(X, S), S > 8. :- brought(X, _, _, _), big(X).",
        lambda t: "g1" not in t.moved(),
        CARRIES,
    ),
    "left_is_mine": Tried(
        "own predicates",
        "left(X, E) :- offset(X, E, _), object(X). :- brought(X, _, _, _), left(X, E), E < 100000.",
        lambda t: not t.moved(),
        CARRIES,
    ),
    "stay_in_room": Tried(
        "world facts",
        ":- occurs(carry(X, P), T), in(X, R, C), C > 50, lies(X, P, S), R != S.",
        lambda t: not any(t.passes(name) for name in t.things),
        CARRIES,
    ),
    "surely_movable": Tried(
        "world facts", ":- brought(X, _, _, _), movable(X, C), C < 101.", lambda t: not t.moved(), CARRIES
    ),
    "wide_links": Tried(
        "world facts",
        ":- occurs(go(D), T), crosses(L, D), link(L, _, _, _, C), C < 9000.",
        lambda t: not t.passes(),
        (GO, SQUARE),
    ),
    "seen_before_carried": Tried(
        "world facts",
        ":- brought(X, _, _, _), X != utak, unseen(R, N), N > 100.",
        lambda t: not t.ends_east("g1"),  # from the door the next room is seen to have more
        (SQUARE,),
    ),
    "stays_near": Tried(
        "world facts",
        "near(X) :- offset(X, E, N), |E| < 800, |N| < 800. :- brought(X, _, _, _), thing(X), not near(X).",
        lambda t: not t.ends_east("g1"),
        (SQUARE,),
    ),
    "empty_hands_through_doors": Tried(
        "world facts",
        ":- held(X), occurs(go(D), T).",
        lambda t: not any(t.passes(name) for name in t.things),
        (SQUARE,),
    ),
    "felt_before_moved": Tried(
        "world facts",
        ":- brought(X, _, _, _), thing(X), not colour(X, _, _).",
        lambda t: not t.moved(),  # no thing is felt without being brought
        (BOTH_CORNERS,),
    ),
    "sure_doors": Tried(
        "world facts", ":- occurs(go(D), T), door(D, C), C < 101.", lambda t: not t.passes(), (GO, SQUARE)
    ),
    "y_early": Tried(
        "aggregates",
        "#minimize { T@2, X : brought(X, _, _, T), meaning(y, X) }.",
        lambda t: t.moved()[:1] == ["r1"],
        BRING_TWO,
    ),
    "ends_at_home": Tried(
        "end states",
        ":- horizon(H), not robot_in(r1, H).",
        lambda t: (t.robot[-1][0] < t.wall) == (t.robot[0][0] < t.wall),
        (GO, SQUARE),
    ),
    "all_seen": Tried(
        "aggregates", ":- #sum { N, R : unseen(R, N) } > 100000.", lambda t: bool(t.passes()), (GO, SQUARE)
    ),
    "few_doors": Tried(
        "aggregates", ":- #count { D : connects(D, _, _) } > 9, occurs(go(E), T).", lambda t: bool(t.passes()), WALKS
    ),
    "a_step_as_a_fact": Tried("refused", "occurs(go(d1), 0).", refused="says what there is"),
    "an_unknown_step": Tried("refused", ":- occurs(jump(X), T).", refused="unknown step jump/1"),
    "a_misspelt_word": Tried("refused", ":- widht(D, W), occurs(go(D), T).", refused="did you mean width?"),
    "a_parameter_as_a_thing": Tried("refused", ":- occurs(carry(x, _), T).", refused="write meaning(x, X)"),
    "a_word_as_a_colour": Tried("refused", ":- brought(X, _, _, _), colour(X, green, _).", refused="lower-case letter"),
    "a_believed_room": Tried("refused", "in(X, r1) :- held(X).", refused="this changes nothing"),
}
