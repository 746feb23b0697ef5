"""Why something is believed or was done: where the engine of explanations is plugged in."""

from typing import Any

from simulator.episode.episode import Episode as EpisodeRecord
from utak.errors import ExplanationUnavailableError


def explain(record: EpisodeRecord, fact: str, step: int) -> Any:
    """Return why a fact is believed, or why a verdict was given, at a step.

    Parameters
    ----------
    record : simulator.episode.episode.Episode
        The header, the steps and the result of a run.
    fact : str
        A fact of the world model such as `shape(o1, square, 95)`, or `verdict(done)`.
    step : int
        The number of the step.

    Returns
    -------
    object
        The explanation; its text is what `print` shows.

    Raises
    ------
    ExplanationUnavailableError
        Always, until an engine of explanations is installed here.
    """
    if "solved" not in record.steps[step]["belief"]:
        raise ExplanationUnavailableError("this episode does not record the decisions that an explanation rests on")
    raise ExplanationUnavailableError(f"this version of Utak does not explain {fact} yet; its rules are in kb/asp")
