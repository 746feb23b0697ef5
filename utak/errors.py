"""Errors of the Python face besides those of Python itself and of the files of users."""


class ExplanationUnavailableError(Exception):
    """No explanation of what was asked is to be had, from this version of Utak or from this episode."""


class RunNotRepeatedError(Exception):
    """A run was repeated, and a step came out otherwise: a mind, or what it uses, is not deterministic."""
