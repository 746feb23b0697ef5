"""`utak show`: print the table of a scenario, or of a step of an episode, as a picture."""

import argparse
import sys
from pathlib import Path
from typing import Any

from utak.simulator.cli.commands.query import step_number
from utak.simulator.scenario.untrusted import add_untrusted_option, refuse_links
from utak.simulator.terminal import exits


def add(parts: Any) -> None:
    """Declare the subcommand."""
    part = parts.add_parser(
        "show",
        help="print the table as a picture with axes and names",
        description="Print the true table as a picture with axes, and the names and places of all things. Labels are "
        "the west and south edges of squares.",
    )
    part.add_argument("source", metavar="SCENARIO|EP.jsonl", help="a scenario folder, or an episode")
    part.add_argument("--at", type=step_number, metavar="STEP", help="the step of the episode (default: the last)")
    part.add_argument("--plain", action="store_true", help="print the picture alone, in the form of world.txt")
    part.add_argument("--svg", metavar="FILE", help="write a picture; of an episode with what is believed upon it")
    part.add_argument("--force", action="store_true", help="let --svg overwrite a file that is no picture")
    add_untrusted_option(part)
    part.set_defaults(execute=execute)


def execute(options: argparse.Namespace) -> int:
    """Print or write the picture; what world.txt cannot state goes to the standard error with `--plain`."""
    from utak.simulator.scenario.picture import draw, labelled, names_and_places

    if options.at is not None and Path(options.source).is_dir():
        print("utak show: --at needs an episode: a scenario has no steps", file=sys.stderr)
        return exits.USAGE
    world, polygons, utak, picture = _table(options)
    if options.svg is not None:
        from utak.simulator.episode.output_files import is_svg, write_whole

        write_whole(options.svg, picture.encode(), is_svg, "SVG picture", options.force)
        return exits.SUCCESS
    rows = draw(world, polygons, utak)
    if options.plain:
        sys.stdout.write(rows)
        if world.heading:
            print(f"Utak faces {world.heading} degrees from the table's north", file=sys.stderr)
        return exits.SUCCESS
    print("\n".join(labelled(rows.splitlines()[::-1], 0, 0)))
    print("\n".join(names_and_places(world, polygons, utak)))
    return exits.SUCCESS


def _table(options: argparse.Namespace) -> tuple[Any, Any, Any, str]:
    """Return the world, the outlines and Utak's place at the step (None for those at the start), and the picture."""
    refuse_links(options, options.source)
    if Path(options.source).is_dir() or not Path(options.source).exists():
        from utak.simulator.scenario.scenario import read_any_world

        world = read_any_world(Path(options.source))
        return world, None, None, _picture_of_world(world) if options.svg is not None else ""
    import shapely

    from utak.kb.language.diagnostics import BadInputError, Problem, SourceSpan
    from utak.simulator.episode.episode import read_begun_episode
    from utak.simulator.episode.record import recorded_world
    from utak.simulator.replay.drawing import step_svg

    episode = read_begun_episode(options.source)
    last = len(episode.steps) - 1
    if options.at is not None and options.at > last:
        what = f"there is no step {options.at}: the last is {last}"
        raise BadInputError([Problem(options.source, SourceSpan(1, 1, 1), what)])
    line = episode.steps[-1 if options.at is None else options.at]
    polygons = {name: shapely.Polygon(ring) for name, ring in line["objects"].items()}
    x, y = line["utak"]
    return recorded_world(episode.header), polygons, (x, y), step_svg(episode, line)


def _picture_of_world(world: Any) -> str:
    """Return the picture of a scenario's table."""
    from utak.simulator.replay.drawing import table_svg

    return table_svg(world)
