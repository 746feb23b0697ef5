"""What commands print under --json: one object, which any strict parser reads."""

import json
from typing import Any


def as_json(value: Any) -> str:
    """Return a value as JSON text; raises ValueError for numbers that JSON has not (nan, inf).

    >>> as_json({"length": 1.5})
    '{"length": 1.5}'
    """
    return json.dumps(value, allow_nan=False)
