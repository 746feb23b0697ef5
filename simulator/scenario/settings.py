"""The options that determine a run."""

from dataclasses import dataclass
from typing import Any

SETTING_NAMES = ("seed", "noise", "paths", "max_steps", "pull")  # as episodes and command lines name the options
MAX_SEED, MAX_NOISE, MAX_STEPS = 2**63 - 1, 1.0, 1_000_000  # the greatest values of options; conventions
PATH_CHOICES = ("skeleton", "visibility", "grid")  # the path-finders, as `--paths` and episodes name them
MIN_RISK, USUAL_RISK, MAX_RISK = 0.0001, 1.0, 99.0  # percent, of certificates of runs with noise; conventions


@dataclass(frozen=True)
class Settings:
    """The options that determine a run; the same settings and scenario give the same episode."""

    seed: int = 0  # the seed of all randomness
    noise: float = 0.0  # how much motions are disturbed, 0 to 1
    paths: str = "skeleton"  # the path-finder: "skeleton", "visibility" or "grid"
    max_steps: int = 200  # the limit on the number of commands
    kb_files: tuple[str, ...] = ()  # the files with users' rules
    pull: bool = True  # whether the robot may pull held objects

    @property
    def options(self) -> dict[str, Any]:
        """The options that are values of JSON, by name; the files of rules are left out."""
        return {name: getattr(self, name) for name in SETTING_NAMES}


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of `--kb`, read and tested once."""
    if paths:
        from utak.kb.reasoning.user_rules import (
            read_tested_rules,  # imported only when there are users' rules: it takes time
        )

        read_tested_rules(paths)
    return tuple(paths)
