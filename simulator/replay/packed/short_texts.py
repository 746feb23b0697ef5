"""JSON values as short texts: LZMA, then base 85 without the signs that mean something in HTML.

LZMA finds again what stood long before, which deflate does not beyond 32 KB: blocks of noisy runs are a quarter
shorter. `page_parts/expand.js` reads such texts.
"""

import base64
import json
from collections.abc import Sequence
from typing import Any

NO_HTML = str.maketrans("&<>`", ".,/:")  # what takes the place of the signs of base 85 that mean something in HTML
FROM_HTML = str.maketrans(".,/:", "&<>`")
LEAST_WINDOW, GREATEST_WINDOW = 1 << 12, 1 << 24  # bytes: how far back copies may begin; a block has some 2 MB
LONGEST_SOUGHT_COPY = 273  # bytes; the greatest value, which packs best


def short_text(values: Sequence[Any]) -> str:
    """Return JSON values as one text of ASCII without blanks."""
    import lzma  # which a Python that was built from its source may lack

    lines = "\n".join(json.dumps(value, separators=(",", ":"), allow_nan=False) for value in values)
    packed = lzma.compress(lines.encode("ascii"), format=lzma.FORMAT_RAW, filters=_filters(len(lines)))
    return base64.b85encode(packed).decode("ascii").translate(NO_HTML)


def values_of(text: str) -> list[Any]:
    """Return the JSON values from which `short_text` made a text."""
    import lzma

    packed = base64.b85decode(text.translate(FROM_HTML))
    lines = lzma.decompress(packed, format=lzma.FORMAT_RAW, filters=_filters(GREATEST_WINDOW)).decode("ascii")
    return [json.loads(line) for line in lines.split("\n")]


def _filters(size: int) -> list[dict[str, Any]]:
    """Return how LZMA packs so many bytes: no bits of the place or of the byte before choose among chances."""
    import lzma

    window = min(max(size, LEAST_WINDOW), GREATEST_WINDOW)
    settings = {"dict_size": window, "lc": 0, "lp": 0, "pb": 0, "mode": lzma.MODE_NORMAL, "mf": lzma.MF_BT4}
    return [{"id": lzma.FILTER_LZMA1, **settings, "nice_len": LONGEST_SOUGHT_COPY}]
