"""The options of a run that decide what happens in it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Settings:
    """The options of a run that decide what happens in it."""

    seed: int = 0
    noise: float = 0.0
    paths: str = "skeleton"
    max_steps: int = 200
    kb_files: tuple[str, ...] = ()
    pull: bool = True


def kb_files_named(paths: list[str]) -> tuple[str, ...]:
    """Return the rule files of --kb, read and checked together once; raises CannotOpenError or BadInputError."""
    if paths:
        from kb.reasoning.user_rules import checked_rules  # only who has rules of his own waits for it

        checked_rules(paths)
    return tuple(paths)
