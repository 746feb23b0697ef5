"""`utak show`: print the table of a scenario, or of a step of an episode, as a picture."""

import argparse
import sys
from pathlib import Path

from utak.kb.language.diagnostics import BadInputError
from utak.simulator.episode.episode import read_begun_episode
from utak.simulator.episode.output_files import is_svg, write_whole
from utak.simulator.episode.record import world_at
from utak.simulator.replay.drawing import step_svg, table_svg
from utak.simulator.scenario.picture import draw, labelled, names_and_places
from utak.simulator.scenario.scenario import read_any_world
from utak.simulator.scenario.untrusted import refuse_links
from utak.simulator.terminal import exits
from utak.simulator.terminal.outcome import UsageError
from utak.simulator.world.world import World


def execute(options: argparse.Namespace) -> int:
    """Print or write the picture; what world.txt cannot state goes to the standard error with `--plain`."""
    if options.at is not None and Path(options.source).is_dir():
        raise UsageError("--at needs an episode: a scenario has no steps")
    world, picture = _table(options)
    if options.svg is not None:
        write_whole(options.svg, picture.encode(), is_svg, "SVG picture", options.force)
        return exits.SUCCESS
    rows = draw(world)
    if options.plain:
        sys.stdout.write(rows)
        if world.heading:
            print(f"Utak faces {world.heading} degrees from the table's north", file=sys.stderr)
        return exits.SUCCESS
    print("\n".join(labelled(rows.splitlines()[::-1], 0, 0)))
    print("\n".join(names_and_places(world, Path(options.source).is_dir())))
    return exits.SUCCESS


def _table(options: argparse.Namespace) -> tuple[World, str]:
    """Return the world at the start or at the step, and the picture that `--svg` asks for."""
    refuse_links(options, options.source)
    if Path(options.source).is_dir() or not Path(options.source).exists():
        world = read_any_world(Path(options.source))
        return world, table_svg(world) if options.svg is not None else ""
    episode = read_begun_episode(options.source)
    last = len(episode.steps) - 1
    if options.at is not None and options.at > last:
        raise BadInputError.at(options.source, f"there is no step {options.at}: the last is {last}")
    line = episode.steps[-1 if options.at is None else options.at]
    return world_at(episode.header, line), step_svg(episode, line)
