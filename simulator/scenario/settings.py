"""The options that determine a run."""

from dataclasses import dataclass

PATH_CHOICES = ("skeleton", "visibility", "grid")  # the path-finders, as `--paths` and episodes name them


@dataclass(frozen=True)
class Settings:
    """The options that determine a run; the same settings and scenario give the same episode."""

    seed: int = 0  # the seed of all randomness
    noise: float = 0.0  # how much motions are disturbed, 0 to 1
    paths: str = "skeleton"  # the path-finder: "skeleton", "visibility" or "grid"
    max_steps: int = 200  # the limit on the number of commands
    kb_files: tuple[str, ...] = ()  # the files with users' rules
    pull: bool = True  # whether the robot may pull held objects


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of `--kb`, read and tested once."""
    if paths:
        from utak.kb.reasoning.user_rules import (
            read_tested_rules,  # imported only when there are users' rules: it takes time
        )

        read_tested_rules(paths)
    return tuple(paths)
