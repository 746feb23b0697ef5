"""`utak verify`: check a certificate against the episode that it belongs to."""

import argparse

from utak.kb.language.diagnostics import BadInputError
from utak.kb.language.source_text import read_bytes
from utak.simulator.certificates.checker import verify
from utak.simulator.certificates.courses import RefusedError, parsed
from utak.simulator.episode.episode import MAX_EPISODE_BYTES
from utak.simulator.terminal import exits
from utak.simulator.terminal.streams import one_line


def execute(options: argparse.Namespace) -> int:
    """Say whether the certificate is accepted, and what it shows or why it is refused."""
    reading = options.certificate
    try:
        certificate = read_bytes(reading, MAX_EPISODE_BYTES).decode("utf-8")
        parsed(certificate)
        reading = options.episode
        shown = verify(read_bytes(reading, MAX_EPISODE_BYTES).decode("utf-8"), certificate)
    except RefusedError as refused:
        print(one_line(f"refused: {refused}"))
        return exits.NOT_REACHED
    except (ValueError, RecursionError) as error:
        what = "an episode" if reading == options.episode else "a certificate"
        raise BadInputError.at(reading, f"this is not {what}, or it is damaged: {error}") from None
    print(one_line(f"accepted: {shown}"))
    return exits.SUCCESS
