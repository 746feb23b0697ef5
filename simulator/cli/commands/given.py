"""The options of a run and the story at a step that several subcommands are given."""

import argparse
from dataclasses import replace
from typing import Any

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.source_text import read_bytes
from utak.simulator.certificates.search import is_certificate
from utak.simulator.episode.episode import MAX_EPISODE_BYTES
from utak.simulator.run.story import Story, open_story
from utak.simulator.scenario.settings import SETTING_NAMES, Settings, kb_files_named
from utak.simulator.scenario.untrusted import refuse_links


def settings_of(options: argparse.Namespace, recorded: dict[str, Any] | None = None) -> Settings:
    """Return the settings of the command line; where it is silent, those of a recorded episode."""
    kept = {name: value for name, value in (recorded or {}).items() if name in SETTING_NAMES}
    return replace(Settings(kb_files=kb_files_named(options.kb)), **{**kept, **given_settings(options)})


def given_settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields of `Settings` that the command line states, by name, without the files of rules."""
    given = {name: getattr(options, name, None) for name in SETTING_NAMES}
    return {name: value for name, value in given.items() if value is not None}


def given_story(options: argparse.Namespace) -> Story:
    """Return the story that the command line names, at step 0."""
    refuse_links(options, options.story)
    return open_story(options.story, settings_of(options))


def given_certificate(options: argparse.Namespace) -> str:
    """Return the text of the certificate that --certificate names; "" without one."""
    if options.certificate is None:
        return ""
    whole = read_bytes(options.certificate, MAX_EPISODE_BYTES)
    if not is_certificate(whole):
        raise BadInputError.at(options.certificate, "this is no certificate")
    return whole.decode("utf-8", "replace")  # what is no UTF-8 is refused where it is checked


def go_to(story: Story, name: str, step: int | None) -> None:
    """Advance to a step, or to the end for None; raise BadInputError when there is no such step."""
    while story.line["step"] != step and story.advance():
        pass
    if step is not None and story.line["step"] != step:
        raise BadInputError.at(name, f"there is no step {step}: the last is {story.line['step']}")
