"""The independent judge of episodes, where it is at hand: $UTAK_JUDGE, or shared/judge/judge.py above the checkout."""

import contextlib
import importlib.util
import io
import os
from functools import cache
from pathlib import Path
from types import ModuleType

CHECKOUT = Path(__file__).resolve().parents[2]


def judge_path() -> Path | None:
    """Return the path of the judge, or None."""
    named = os.environ.get("UTAK_JUDGE")
    paths = [Path(named)] if named else [above / "shared" / "judge" / "judge.py" for above in CHECKOUT.parents]
    return next((path for path in paths if path.is_file()), None)


@cache
def judge_module(path: Path) -> ModuleType:
    """Return the judge at a path as a module."""
    spec = importlib.util.spec_from_file_location("utak_judge", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load the judge from {path}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def findings(folder: Path, episode: Path) -> list[str] | None:
    """Return what the judge finds in an episode, one finding a line; None when there is no judge."""
    path = judge_path()
    if path is None:
        return None
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        try:
            code = judge_module(path).main(str(folder), str(episode))
        except (OSError, KeyError, ValueError, RuntimeError, SystemExit) as error:
            return [f"the judge cannot read the episode: {type(error).__name__}: {error}"]
    return said.getvalue().splitlines() if code else []
