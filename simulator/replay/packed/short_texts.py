"""JSON values as short texts: LZMA, then base 85 without the signs that mean something in HTML.

LZMA finds again what stood long before, which deflate does not beyond 32 KB: blocks of noisy runs are a quarter shorter.
`page_parts/expand.js` reads such texts.
"""

import base64
import json
from collections.abc import Sequence
from typing import Any

NO_HTML = str.maketrans("&<>`", ".,/:")  # what takes the place of the signs of base 85 that mean something in HTML
WINDOW_BYTES = 1 << 23  # how far back copies may begin; more than a block has
LONGEST_SOUGHT_COPY = 273  # bytes; the greatest value, which packs best


def short_text(values: Sequence[Any]) -> str:
    """Return JSON values as one text of ASCII without blanks.

    Parameters
    ----------
    values : the values, each of which is written on a line of its own, so that a reader can parse them one by one.

    Returns
    -------
    The lines, as a raw stream of LZMA with its mark of the end, in base 85.

    Raises
    ------
    ImportError : this Python was built without its module lzma.
    """
    import lzma  # which a Python that was built from its source may lack

    lines = "\n".join(json.dumps(value, separators=(",", ":"), allow_nan=False) for value in values)
    filters = [
        {
            "id": lzma.FILTER_LZMA1,
            "dict_size": WINDOW_BYTES,
            "lc": 0,
            "lp": 0,
            "pb": 0,
            "mode": lzma.MODE_NORMAL,
            "mf": lzma.MF_BT4,
            "nice_len": LONGEST_SOUGHT_COPY,
        }
    ]
    packed = lzma.compress(lines.encode("ascii"), format=lzma.FORMAT_RAW, filters=filters)
    return base64.b85encode(packed).decode("ascii").translate(NO_HTML)
