"""Runs kept in a folder: each episode with its certificate, or with the reason why there is none."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from utak.kb.language.diagnostics import CannotOpenError
from utak.simulator.certificates.search import NoCertificateError, certificate_of, is_certificate
from utak.simulator.episode.episode import EpisodeLine, encode
from utak.simulator.episode.output_files import is_episode, write_whole

NO_CERTIFICATE = "no certificate: "  # begins the text that says why there is none


def kept_texts(lines: Sequence[EpisodeLine], verdict: str | None, risk: float) -> dict[str, str]:
    """Return texts by the ends of their files' names: the episode (.jsonl) and its certificate (.json), or why none.

    risk : of a certificate of a run with noise, percent.
    """
    encoded = list(map(encode, lines))
    episode = {".jsonl": "".join(encoded)}
    try:
        return episode | {".json": certificate_of(encoded, verdict, risk)}
    except NoCertificateError as why:
        return episode | {".txt": f"{NO_CERTIFICATE}{why}\n"}


def make_folder(folder: str) -> None:
    """Make a folder for kept runs, where there is none; raises CannotOpenError."""
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CannotOpenError(folder, error.strerror or str(error)) from None


def keep(folder: str, name: str, texts: Mapping[str, str], force: bool = False) -> None:
    """Write the texts of a run into a folder; files of other kinds are not overwritten without `force`."""
    kinds = {
        ".jsonl": (is_episode, "episode"),
        ".json": (is_certificate, "certificate"),
        ".txt": (lambda head: head.startswith(NO_CERTIFICATE.encode()), "reason why there is no certificate"),
    }
    for end, (kind, what) in kinds.items():
        path = Path(folder) / f"{name.replace('/', '-')}{end}"
        if end in texts:
            write_whole(path, texts[end].encode(), kind, what, force)
        elif path.exists() and end != ".jsonl":  # of an earlier run
            write_whole(path, b"", kind, what, force)
            path.unlink()
