"""What users may call things in questions, beside the names that the knowledge base has for them."""

import re

UTAK, ROOT = "utak", "org"  # as tasks and as the knowledge base call the robot
TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[A-Za-z0-9_\']+')


def with_utak(query: str) -> str:
    """Return a query in which the robot, called `utak`, has the name that the world model has for it.

    >>> with_utak('held(utak), X = "utak"')
    'held(org), X = "utak"'
    """
    return TOKEN.sub(lambda match: ROOT if match[0] == UTAK else match[0], query)
