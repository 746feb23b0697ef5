"""Random input facts of each encoding, over few constants, so that rules meet each other."""

from itertools import product
from pathlib import Path

from hypothesis import strategies as st

from tests.encoding_cases import ENCODINGS

BY_NAME = {path.stem: path for path in ENCODINGS}
HOW = ("predicted", "blocked", "slipped", "turned", "misled", "smaller", "larger", "stuck")
LINKS = ("l1", "l2")
EXPLANATIONS, REGIONS, NODES, THINGS, NUMBERS = (1, 2, 3), ("a", "b", "c"), ("n1", "n2"), ("x", "y"), (1, 2, 3)
CLASSES, PROPERTIES, VALUES = ("square", "brick", "disc"), ("shape", "colour"), ("square", "g")
WAYS = (4, 5, 6)  # numbers of ways
KINDS = "attain", "explore", "pass", "settle"
ACTIVITIES = (
    "keep",
    "resume(clear)",
    "errand",
    "examine(g1)",
    "carry(g1)",
    "go",
    "wish",
    "look",
    "pull(g1)",
    "feel(g1)",
)
# By encoding: of each input predicate the values of its arguments.
INPUTS: dict[str, dict[str, tuple[tuple[object, ...], ...]]] = {
    "accommodation": {
        "explanation": (EXPLANATIONS, HOW, (0, 1), (0, 1, 2)), "unlikely": (EXPLANATIONS, (3, 12)),
        "odd": (EXPLANATIONS,), "crooked": (EXPLANATIONS, (4, 9)), "stands": (), "met": (EXPLANATIONS,),
        "off_middle": (), "trust": ((2, 9),), "slips": (), "proven": (), "clear": (), "uneven": (), "unchanged": (),
    },
    "corners": {"convex": (NUMBERS, (0, 50, 100), (-50, 0, 100))},
    "interpretation": {
        "region": (REGIONS, ("zero", "nonzero"), (90, 100)), "rim": (REGIONS,), "own": (REGIONS,),
        "surrounds": (REGIONS, REGIONS), "extent": (REGIONS, (3, 14, 30)), "mass": (REGIONS, (10, 40)),
        "touched": (REGIONS, ("b", "g")),
    },
    "reconciliation": {
        "wanted": (THINGS,), "named": (THINGS,), "claim": (THINGS, PROPERTIES, VALUES, (40, 100)),
        "candidate": (NODES, (15, 60, 95)), "has": (NODES, PROPERTIES, VALUES, (30, 99)),
        "settled": (NODES, PROPERTIES), "distance": (NODES, (3, 9)), "bound_before": (THINGS, NODES),
        "carried": (THINGS,), "fixed": (NODES,), "moved": (NODES,), "may_have": (NODES, PROPERTIES, VALUES),
        "planned": (THINGS, NODES), "kept": (THINGS,), "given_up": (THINGS, NODES),
    },
    "rooms": {"neck": (NUMBERS, (50, 100), (100, 150, 300), (100, 300), (0, 90))},
    "shapes": {
        "fit": (("o1", "o2"), CLASSES, (0, 1, 2, 4), NUMBERS), "open_squares": (("o1", "o2"), (0, 4, 40)),
        "full_squares": (("o1", "o2"), (9, 12)),
    },
    "deciding": {
        "stage_goal": (("g1", "g2"), (1, 2)), "missing": (("g1", "g2"),), "unclear": (("g1", "g2"),),
        "own_goals": (), "regions_forbidden": (),
        "stages_attained": (), "constraints_doubtful": (), "robot_lost": (), "map_contradicted": (),
        "hand_unsure": (), "begun": (("clear", "feel"),), "came_to": (ACTIVITIES, ("idle", "done", "impossible")),
        "aim": (NUMBERS, KINDS, (10, 50, 90)), "chance": (NUMBERS, (20, 50, 100)), "last": ((*NUMBERS, *WAYS),),
        "aim_price": (NUMBERS, (30, 200)),
        "halt": (NUMBERS, (20, 90), (1, 2)), "tells": (NUMBERS, ("thing", "plain"), ("doorway", "square"), (1, 3)),
        "begins": (("j1",),), "ends": (("j2",),), "link": (LINKS, ("j1",), ("j2", "j3"), (400, 600), (50, 200)),
        "crosses": (LINKS, ("d1", "d2")), "tight": (WAYS, (400, 600), (50, 200), (0, 30)), "part": (WAYS, LINKS),
        "through": (WAYS, ("d1", "d2")), "not_through": (("d1", "d2"),), "avoid_link": (LINKS,),
        "offered": ((0, 1), ("go(1,2)", "look(1,2)", "push(o1,1,2)", "grasp(o1,north)")), "holds": (("o1",),),
    },
}  # fmt: skip
# By encoding: shown predicates, with the values of their arguments.
ANSWERS: dict[str, dict[str, tuple[tuple[object, ...], ...]]] = {
    "accommodation": {"chosen": (EXPLANATIONS,)},
    "corners": {"furthest": (("northeast", "southwest"), NUMBERS)},
    "interpretation": {
        "kind": (REGIONS, ("utak", "floor", "verge", "object"), (48, 92, 95, 99, 100)),
    },
    "reconciliation": {
        "bind": (THINGS, NODES), "hypothesised": (THINGS,), "doubtful": (THINGS, NODES), "unmovable": (THINGS, NODES),
        "as_well": (THINGS, NODES),
    },
    "rooms": {"door": (NUMBERS, (90,)), "opening": (NUMBERS,)},
    "shapes": {"shape": (("o1",), (*CLASSES, "polygon"), (2, 30, 62, 74, 98, 99))},
    "deciding": {
        "do": (ACTIVITIES,), "stage_attained": (), "verdict": (("done", "limit", "impossible", "possible_if"),),
        "choose": (NUMBERS,), "step": (LINKS, ("j1",), ("j2", "j3")), "walked": (WAYS,), "begun": (),
    },
}  # fmt: skip


def atoms_over(predicates: dict[str, tuple[tuple[object, ...], ...]]) -> list[str]:
    """Return all atoms of some predicates, as clingo writes them."""
    found = []
    for name, options in predicates.items():
        for values in product(*options):
            found.append(f"{name}({','.join(map(str, values))})" if values else name)
    return found


def random_facts(encoding: str, size: int) -> st.SearchStrategy[list[str]]:
    """Return a strategy for input facts of an encoding: each predicate is as likely as any other."""
    by_predicate = [st.sampled_from(atoms_over({name: options})) for name, options in INPUTS[encoding].items()]
    return st.lists(st.one_of(by_predicate), max_size=size, unique=True).map(sorted)


def encoding_path(name: str) -> Path:
    """Return the path of an encoding."""
    return BY_NAME[name]
