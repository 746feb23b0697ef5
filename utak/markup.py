"""Tables and captions for notebooks, as HTML."""

from collections.abc import Iterable, Sequence
from html import escape

CELL_STYLE = "padding:2px 8px;text-align:left;vertical-align:top"


def framed(caption: str, picture: str) -> str:
    """Return a picture with a caption below; both are markup already."""
    return f'<figure style="margin:0">{picture}<figcaption>{caption}</figcaption></figure>'


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table of texts: heads and rows are plain text, which is escaped here."""
    head = "".join(f'<th style="{CELL_STYLE}">{escape(text)}</th>' for text in heads)
    body = "".join(
        "<tr>" + "".join(f'<td style="{CELL_STYLE}">{escape(str(value))}</td>' for value in row) + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
