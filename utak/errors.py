"""Errors of the Python face besides those of Python itself and of the files of users."""


class RunNotRepeatedError(Exception):
    """A run was repeated, and a step came out otherwise: a mind, or what it uses, is not deterministic."""
