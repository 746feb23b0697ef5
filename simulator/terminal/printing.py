"""Output under `--json`: one object that every strict parser reads."""

import json
from typing import Any


def as_json(value: Any) -> str:
    """Return a value as JSON text; raise ValueError for numbers that JSON lacks (NaN, infinity).

    >>> as_json({"length": 1.5})
    '{"length": 1.5}'
    """
    return json.dumps(value, allow_nan=False)
