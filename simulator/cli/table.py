"""The table of the subcommands of `utak`: of each its name, its words, its arguments, and the module that runs it.

The parser, the help and docs/reference/commands.md are made from it.
"""

import argparse
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from utak.simulator.scenario.settings import (
    MAX_NOISE,
    MAX_RISK,
    MAX_SEED,
    MAX_STEPS,
    MIN_RISK,
    PATH_CHOICES,
    USUAL_RISK,
)
from utak.simulator.terminal.numbers import decimal, point, whole

MAX_LIMIT_ROWS = 1_000_000  # the greatest --limit, in rows; a convention
MAX_FIX_NUMBER = 100_000  # the greatest --runs and --number; a convention
MAX_FIX_SECONDS = 1e9  # the greatest --seconds of `explain --fix`; a convention
MIN_SECONDS, MAX_SECONDS = 0.001, 1_000_000  # the bounds of `--seconds` of runs; conventions
MAX_LEVEL_NUMBER = 1_000_000  # the greatest --level; a convention
MAX_START_COORDINATE = 1e7  # the greatest coordinate of --start, in absolute value; a convention
MAX_ROUTES_ASKED = 1000  # the greatest -k; a convention
MAX_POINT_COORDINATE = 1e6  # squares; the greatest absolute value in --from and --to; a convention
MAX_TEST_JOBS, MAX_SWEEP_JOBS = 256, 1024  # the greatest --jobs; conventions
MAX_SHARDS = 100_000  # the greatest N of --shard I/N; a convention
SCHEMA_NAMES = (
    *("episode", "header", "step", "end"),
    *("run", "query", "plan", "routes", "test", "explain", "fix", "sweep", "sweep_row"),
)


class Argument(NamedTuple):
    """One argument of a subcommand, as argparse declares it."""

    names: tuple[str, ...]
    given: dict[str, Any]

    def declare(self, part: Any) -> None:
        """Declare the argument in a parser or a group."""
        part.add_argument(*self.names, **self.given)


class Together(NamedTuple):
    """Arguments that exclude each other; or, with a title, those that the help lists apart."""

    arguments: tuple[Argument, ...]
    title: str = ""
    description: str = ""

    def declare(self, part: Any) -> None:
        """Declare the arguments in a parser."""
        titled = part.add_argument_group(self.title, self.description) if self.title else None
        for one in self.arguments:
            one.declare(titled := titled or part.add_mutually_exclusive_group())


class Subcommand(NamedTuple):
    """One subcommand; `module` below simulator.cli.commands has the function `execute` that runs it."""

    name: str
    module: str
    summary: str  # in the list of commands
    arguments: Sequence[Argument | Together] = ()
    description: str | None = None  # above its own help
    epilog: str | None = None  # below its own help


def value(names: str, metavar: str | None, what: str, read: Callable[[str], Any] = str, **more: Any) -> Argument:
    """Return an argument with a value; one of several names is parted by a blank."""
    return Argument(tuple(names.split()), {"metavar": metavar, "help": what, "type": read, **more})


def flag(names: str, what: str, **more: Any) -> Argument:
    """Return an option without a value."""
    return Argument((names,), {"action": "store_true", "help": what, **more})


def _seeds(text: str) -> tuple[tuple[int, int], ...]:
    from utak.simulator.sweep.plan import parse_seeds

    try:
        return parse_seeds(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _shard(text: str) -> tuple[int, int]:
    which, slash, number = text.partition("/")
    if not slash:
        raise argparse.ArgumentTypeError(f"{text[:40]!r} is no shard: write I/N")
    count = whole(1, MAX_SHARDS)(number)
    return whole(1, count)(which), count


def _cell(text: str) -> int:
    from utak.geometry.counts.retina import FIELD_COUNT

    return whole(0, FIELD_COUNT - 1)(text)


def _noises(text: str) -> tuple[float, ...]:
    return tuple(dict.fromkeys(decimal(0, MAX_NOISE)(part) for part in text.split(",")))


def _scale(text: str) -> Fraction:
    from utak.simulator.importing.imported import MAX_CELL_SCALE

    size = whole(1, MAX_CELL_SCALE)
    return Fraction(1, size(text[2:])) if text.startswith("1/") else Fraction(size(text))


DUMP = "write program and facts of every decision into this folder, as plain clingo reads them"
STORY = value("story", "SCENARIO|EP.jsonl", "a scenario folder, which is run, or an episode")
UNTRUSTED = flag("--untrusted", "refuse links that lead out of a scenario's folder")
RUN_SECONDS = decimal(MIN_SECONDS, MAX_SECONDS)
ORIGINS = ("bottom", "top")
RISK = value(
    "--risk",
    "PERCENT",
    f"how likely a certificate may be wrong by noise, at most (default {USUAL_RISK:g})",
    decimal(MIN_RISK, MAX_RISK),
    default=USUAL_RISK,
)
ROBOT_OPTIONS = (
    value("--paths", None, "how routes are found (default skeleton)", choices=PATH_CHOICES),
    flag("--no-pull", "push what is held, never pull", dest="pull", action="store_false", default=None),
    value("--max-steps", "N", "give up after so many commands (default 200)", whole(0, MAX_STEPS)),
    value("--kb", "FILE", "a file of rules to add; repeatable", action="append", default=[]),
    UNTRUSTED,
)
SETTINGS = (
    value("--seed", "N", "seed of all randomness (default 0)", whole(0, MAX_SEED)),
    value("--noise", "S", "how much motions are disturbed, 0 to 1 (default 0)", decimal(0, MAX_NOISE)),
    *ROBOT_OPTIONS,
)


def at(what: str) -> Argument:
    """Return the option for a step."""
    return value("--at", "STEP", what, whole(0, MAX_STEPS))


RUN = (
    value("scenario", "SCENARIO", "a scenario folder"),
    *SETTINGS,
    value("--disturb", "FILE", "what others do meanwhile: facts move, lift, appear, vanish, each with a step"),
    value("--log", "EP.jsonl", "write the episode to this file as it happens; - is the standard output"),
    value("--html", "FILE", "write the whole run as a page that plays it in any browser"),
    value("--seconds", "S", "end a run that takes longer, also within a step", RUN_SECONDS),
    flag("--resume", "go on from the episode that --log names"),
    value(
        "--from",
        "EP.jsonl",
        "repeat this episode up to --at, then go on with the task of SCENARIO and the options given now",
        dest="origin",
    ),
    at("the last step of --from that is repeated"),
    value("--from-kb", "FILE", "a file of rules of the repeated run; repeatable", action="append", default=[]),
    value("--certificate", "FILE", "write why the verdict follows, for `utak verify`, where that can be shown"),
    RISK,
    value("--dump-asp", "DIR", DUMP),
    flag("--force", "let --log, --html, --certificate overwrite files of other kinds, and --dump-asp fill a folder"),
    flag("--json", "print the result as one JSON object"),
    flag(
        "--watch",
        "draw the true table, which the robot does not see, on stderr after every step; on a terminal in place",
    ),
)
CERTIFICATES = value(
    "--certificate", "FOLDER", "write each episode there, with why its verdict follows, for `utak verify`, or why not"
)
TEST = (
    value("folders", "FOLDER", "a scenario, or a folder of scenarios", nargs="+"),
    *SETTINGS,
    value("-k", "NAME", "only scenarios with NAME in their path", dest="name", default=""),
    value("--jobs", "N", "run so many at once (default 1)", whole(1, MAX_TEST_JOBS), default=1),
    flag("--json", "print all outcomes as one JSON object"),
    value("--junit", "FILE", "write all outcomes to this file as JUnit XML"),
    value("--csv", "FILE", "write the points of all scenarios to this file as a table"),
    flag("--times", "say in --json and --junit how long each scenario took"),
    CERTIFICATES,
    RISK,
    flag("--force", "let --junit, --csv and --certificate overwrite files of other kinds"),
)
SWEEP = (
    value("scenarios", "SCENARIO", "a scenario, or a folder of scenarios", nargs="+"),
    value("--seeds", "A:B", "seeds A to B-1; also A,C:D,... (default 0)", _seeds, default=((0, 1),)),
    value("--noise", "S,...", "noises, each 0 to 1 (default 0)", _noises, default=(0.0,)),
    Together(
        (
            value(
                "--jobs", "N", "runs at once; 0 for one a processor (default 1)", whole(0, MAX_SWEEP_JOBS), default=1
            ),
            value("--dask", "ADDRESS", "run on the workers of this Dask scheduler, tcp://HOST:PORT"),
        )
    ),
    value("--shard", "I/N", "only every N-th run, from the I-th on", _shard, default=(1, 1)),
    value("-o --output", "FILE", "a JSON line for each run; - is the standard output"),
    flag("--force", "begin anew, and overwrite whatever the files hold"),
    value("--seconds", "S", "end a run that takes longer than S seconds", RUN_SECONDS),
    *ROBOT_OPTIONS,
    value("--svg", "FILE", "draw success rates and numbers of commands"),
    CERTIFICATES,
    RISK,
    flag("--json", "print the summary as one JSON object"),
)
CHECK = (
    value(
        "paths", "FILE|FOLDER", "a scenario, a folder of them, a file of one, or a file of rules for --kb", nargs="+"
    ),
    UNTRUSTED,
)
SHOW = (
    value("source", "SCENARIO|EP.jsonl", "a scenario folder, or an episode"),
    at("the step of the episode (default: the last)"),
    flag("--plain", "print the picture alone, in the form of world.txt"),
    value("--svg", "FILE", "write a picture; of an episode with what is believed upon it"),
    flag("--force", "let --svg overwrite a file that is no picture"),
    UNTRUSTED,
)
IMPORT = (
    value("file", "FILE", "the file; the end of its name tells the format"),
    value("folder", "FOLDER", "the folder to make"),
    value("--scale", "N|1/N", "squares along a cell; 1/N (maps): one square for N x N cells", _scale),
    value("--level", "N", "the level of a Sokoban file (default 1)", whole(1, MAX_LEVEL_NUMBER)),
    value("--goal", "FACT", "another goal than that of the file, such as 'in(utak, room(next)).'"),
    value("--start", "X,Y", "where the robot wakes: cells of a .map, metres of a ROS map", point(MAX_START_COORDINATE)),
    value("--origin", None, "the edge of a .map from which --start counts y (default bottom)", choices=ORIGINS),
    value("--unknown", None, "what unknown pixels of a ROS map are (default verge)", choices=("verge", "floor")),
    flag("--untrusted", "refuse links that lead out of the file's folder, and images of ROS maps beyond it"),
    flag("--force", "replace the scenario in a folder that is not empty"),
)
QUERY = (
    STORY,
    value("query", "QUERY", 'such as "object(X), shape(X, square, C)"'),
    at("the step to ask at (default: the last; 0: on waking)"),
    flag("--json", "print the answer as one JSON object"),
    value("--limit", "N", "print so many rows at most (default 10000)", whole(1, MAX_LIMIT_ROWS)),
    value("--dump-asp", "DIR", f"{DUMP}: those of an episode up to the step"),
    flag("--force", "let --dump-asp fill a folder that is not empty"),
    *SETTINGS,
)
PLAN = (STORY, at("the step whose plan is shown (0: on waking)"), flag("--json", "print the plan as one JSON object"))
TOLD_CERTIFICATE = value("--certificate", "FILE", "a certificate of the run, which is told with its verdict")
DEPTHS = ("short", "mid", "long")  # kb.evidence.reason.Depth, which every command would load here
EXPLAIN = (
    STORY,
    value("fact", "FACT", "a fact, a goal or verdict(V); without it the command of the step", nargs="?"),
    value("--whynot", "FACT", "why a fact is not believed: what is missing or in the way"),
    value("--cell", "N", "a cell of the impression of the step, 0 to 159", _cell),
    TOLD_CERTIFICATE,
    at("the step (default: the last)"),
    value("--depth", None, "how much of the tree is printed (default mid)", choices=DEPTHS, default="mid"),
    flag("--json", "print the whole tree as one JSON object"),
    *SETTINGS,
    Together(
        (
            flag("--fix", "the smallest changes with which the run works, each proved by running again"),
            value("--runs", "N", "with --fix: at most so many runs (default 40)", whole(1, MAX_FIX_NUMBER)),
            value("--seconds", "S", "with --fix: end after so many seconds", decimal(0, MAX_FIX_SECONDS)),
            value("--write", "FOLDER", "with --fix: write the changed scenario as a folder"),
            value(
                "--number",
                "K",
                "with --write: the K-th change (default: the first that files state)",
                whole(1, MAX_FIX_NUMBER),
            ),
        ),
        "fixing",
        "what would have made a run work that failed",
    ),
)
REPLAY = (
    value("episode", "EP.jsonl", "an episode that `utak run --log` wrote"),
    Together(
        (
            value("--html", "FILE", "write one page of HTML that plays it in any browser"),
            value("--gif", "FILE", "write a moving picture (needs pillow: pip install pillow)"),
            flag("--text", "print actions, reasons, tables and changed facts (default)"),
        )
    ),
    value("--kb", "FILE", "with --html: a file of rules of the run; repeatable", action="append", default=[]),
    value("--certificate", "FILE", "with --html: a certificate, which the page draws and checks"),
    flag("--force", "overwrite a file that is no page or picture"),
)
VERIFY = (
    value("episode", "EP.jsonl", "an episode that `utak run --log` wrote"),
    value("certificate", "CERTIFICATE", "a certificate that `utak run --certificate` wrote, or somebody else"),
)
PLACE = point(MAX_POINT_COORDINATE)
ROUTES = (
    value("map", "MAP|SCENARIO", "a .map file, or a scenario folder"),
    value("--from", "X,Y", "where the ways begin", PLACE, dest="start", required=True),
    value("--to", "X,Y", "where they end", PLACE, dest="goal", required=True),
    value("--origin", None, "the corner from which points count (see below)", choices=ORIGINS, default="bottom"),
    value("-k", "N", "how many ways at most (default 3)", whole(1, MAX_ROUTES_ASKED), default=3),
    flag("--json", "print one JSON object"),
    value("--svg", "FILE", "draw squares, skeleton, pathgraph and ways"),
    UNTRUSTED,
    flag("--force", "let --svg overwrite a file that is no picture"),
)
SCHEMA = value(
    "name",
    "NAME",
    "episode (a line of one; the default), header, step, end; the output of run, query, plan, routes, test, explain, "
    "fix (explain --fix), sweep; sweep_row (a line of a sweep's results)",
    nargs="?",
    choices=SCHEMA_NAMES,
    default="episode",
)

# In the order of the help text.
SUBCOMMANDS = (
    Subcommand("run", "run", "run the robot on a scenario", RUN),
    Subcommand("test", "test", "run scenario folders as tests", TEST),
    Subcommand(
        "sweep",
        "sweep",
        "run scenarios with many seeds and noises, in parallel",
        SWEEP,
        "Run scenarios with many seeds and noises, in parallel, and sum up what came out.",
        "A run is named by a digest of scenario, seed, noise, options and code. Runs that the file of results has are "
        "not carried out again; others are appended. Files of several shards are joined by putting one after the "
        "other.",
    ),
    Subcommand("check", "files.check", "check scenarios or single files of them", CHECK),
    Subcommand(
        "show",
        "files.show",
        "print the table as a picture with axes and names",
        SHOW,
        "Print the true table as a picture with axes, and the names and places of all things. Labels are the west and "
        "south edges of squares.",
    ),
    Subcommand(
        "new", "files.new", "write a small scenario to start from", [value("folder", "FOLDER", "the folder to make")]
    ),
    Subcommand(
        "import",
        "files.import_scenario",
        "write the scenario of a file of another format (PushWorld, Sokoban, Moving AI, NAMOSIM, ROS)",
        IMPORT,
        "Write the scenario of a file of another format.",
        "Formats, by the end of the name: .pwp PushWorld; .xsb, .sok, .txt Sokoban; .map Moving AI; .svg NAMOSIM; "
        ".yaml, .yml, .pgm, .png, .bmp ROS maps. docs/importing.md says what becomes of each.",
    ),
    Subcommand("query", "query", "ask what Utak believes", QUERY),
    Subcommand(
        "plan",
        "plan",
        "show what the robot means to do: the task plan of a step",
        [*PLAN, *SETTINGS],
        "Show the task plan: its steps with their cost and what geometry says of each, the lower bound, and what was "
        "refuted.",
        "Of a scenario, without --at, the robot runs until it has a plan or a verdict; of an episode the last plan "
        "that has steps left is shown. Where no plan attains all goals, those that none attains, what was refuted and "
        "the steps that settle what is open are shown as far as they are known, and the exit code is 1.",
    ),
    Subcommand("repl", "repl", "step through a run and ask what Utak believes", [STORY, TOLD_CERTIFICATE, *SETTINGS]),
    Subcommand("explain", "explain", "tell why: a fact, a command, a verdict, a cell of an impression", EXPLAIN),
    Subcommand(
        "replay",
        "replay",
        "show a recorded episode step by step",
        REPLAY,
        "Show a recorded episode step by step: as text on the standard output, or in a file.",
    ),
    Subcommand(
        "verify",
        "files.verify",
        "check the certificate of a verdict, by what was seen, felt and commanded alone",
        VERIFY,
        "Check that the claim of a certificate follows from the impressions and commands of an episode.",
        "The exit code is 0 when it does and 1 when the certificate is refused. docs/certificates.md has the axioms "
        "and the format.",
    ),
    Subcommand(
        "routes",
        "routes",
        "find distinct ways on a Moving AI map or a scenario's table",
        ROUTES,
        "Find topologically distinct ways between two points of a map or of a scenario's table.",
        "Points are in squares, with fractions. With --origin bottom, the default, (0, 0) is the south-west corner, x "
        "goes east and y north, as in scenarios. With --origin top, (0, 0) is the north-west corner, x goes east and "
        "y SOUTH, as in .scen files of the Moving AI benchmarks; a line of those names squares by whole numbers, and "
        "the middle of their square A, B is the point A+0.5,B+0.5. The ways are printed with the same origin.",
    ),
    Subcommand(
        "schema", "schema", "print the JSON Schema of episodes, or of what a command prints under --json", [SCHEMA]
    ),
    Subcommand("warm", "warm", "compile the geometry kernels now, so that no run waits for them"),
)
