"""Why something is believed or was done: trees of reasons, from a rule down to cells of impressions."""

from dataclasses import dataclass
from html import escape
from typing import Any

from utak.kb.evidence.reason import Depth, Reason

OPEN_LEVELS = 2  # levels of a tree that a notebook shows unfolded; a convention


@dataclass(frozen=True, repr=False)
class ReasonTree:
    """A claim and why it holds, as a tree. It prints itself, and unfolds in notebooks.

    Attributes
    ----------
    reason : kb.evidence.reason.Reason
        The root of the tree: `claim`, `because`, `kind`, `source`, `rests_on` and `data`.
    lacking : str
        What the explanation lacks, in a line: rules of the run that are not given; "" for nothing.
    """

    reason: Reason
    lacking: str = ""

    @property
    def claim(self) -> str:
        """The claim: a fact or an atom as text, or a statement in words."""
        return self.reason.claim

    def text(self, depth: str = "mid") -> str:
        """Return the tree as indented lines.

        Parameters
        ----------
        depth : str
            "short" for one line, "mid" for three levels, "long" for all.

        Raises
        ------
        ValueError
            There is no such depth.
        """
        return self.reason.text(Depth(depth))

    def as_dict(self) -> dict[str, Any]:
        """Return the whole tree as JSON values."""
        return self.reason.as_dict()

    def __str__(self) -> str:
        """Return three levels of the tree as text, and what it lacks below."""
        return "\n".join(filter(None, (self.text(), self._note)))

    def __repr__(self) -> str:
        """Return what `print` shows, so that it can be read at a prompt."""
        return str(self)

    def _repr_html_(self) -> str:
        """Return the whole tree for notebooks, to be unfolded, and what it lacks below."""
        return _unfolding(self.reason, OPEN_LEVELS) + (f"<p>{escape(self._note)}</p>" if self.lacking else "")

    @property
    def _note(self) -> str:
        """The line about what is lacking, and how that is mended; "" for nothing."""
        return f"note: {self.lacking}; give rules with Episode.read(path, rules=[...])" if self.lacking else ""


def _unfolding(reason: Reason, levels: int) -> str:
    """Return a tree as HTML in which what a claim rests on unfolds; the first levels are unfolded."""
    because = f": {escape(reason.because)}" if reason.because else ""
    source = f" <small>[{escape(reason.source)}]</small>" if reason.source else ""
    claim = f"<code>{escape(reason.claim)}</code>{because}{source}"
    if not reason.rests_on:
        return f"<div>{claim}</div>"
    below = "".join(_unfolding(one, levels - 1) for one in reason.rests_on)
    unfolded = ' open="open"' if levels > 0 else ""
    return f'<details{unfolded}><summary>{claim}</summary><div style="margin-left:1.5em">{below}</div></details>'
