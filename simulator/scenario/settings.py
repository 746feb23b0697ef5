"""The options that determine a run."""

from dataclasses import dataclass

PATH_CHOICES = ("skeleton", "visibility", "grid")  # the path-finders, as `--paths` and episodes name them


@dataclass(frozen=True)
class Settings:
    """The options that determine a run; the same settings and scenario give the same episode.

    Attributes
    ----------
    seed : the seed of all randomness.
    noise : how much motions are disturbed, 0 to 1.
    paths : the path-finder: "skeleton", "visibility" or "grid".
    max_steps : the limit on the number of commands.
    kb_files : the files with users' rules.
    pull : whether the robot may pull held objects.
    """

    seed: int = 0
    noise: float = 0.0
    paths: str = "skeleton"
    max_steps: int = 200
    kb_files: tuple[str, ...] = ()
    pull: bool = True


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of `--kb`, read and tested once.

    Parameters
    ----------
    paths : the names of the files.

    Returns
    -------
    The names of the files.

    Raises
    ------
    CannotOpenError : a file cannot be read.
    BadInputError : the rules have errors.
    """
    if paths:
        from kb.reasoning.user_rules import (
            read_tested_rules,  # imported only when there are users' rules: it takes time
        )

        read_tested_rules(paths)
    return tuple(paths)
