"""The table of oracles: each question to geometry whose answer the task plan rests on, and the facts that answer it."""

from enum import StrEnum
from typing import NamedTuple


class CostClass(StrEnum):
    """The times at which oracles are asked.

    Attributes
    ----------
    BEFORE : it is cheap, and its answers are facts before the first plan is proposed.
    WHEN_IN_WAY : it is asked for things that were found to be in the way of others.
    LAZY : it is dear, and asked for the steps of proposed plans alone, each in the state that it would be done in.
    """

    BEFORE = "before"
    WHEN_IN_WAY = "when in the way"
    LAZY = "lazy"


class OracleEntry(NamedTuple):
    """One oracle.

    Attributes
    ----------
    name : a word.
    question : what it is asked.
    module : where it is computed.
    facts : the facts of planner/asp/task that hold its answers.
    certifies : what an answer guarantees.
    cost : when it is asked.
    """

    name: str
    question: str
    module: str
    facts: tuple[str, ...]
    certifies: str
    cost: CostClass


ORACLES = (
    OracleEntry(
        "rooms",
        "in which room does a place lie, and which doors connect which rooms?",
        "planner.tasking.facts",
        ("lies/3", "connects/3", "width/2"),
        "most squares of the place are labelled with that room; where no room holds most of it, nothing is stated",
        CostClass.BEFORE,
    ),
    OracleEntry(
        "overlap",
        "would two things lie on the same squares?",
        "planner.tasking.facts",
        ("overlap/4",),
        "the outlines at the two places share an area; regions in which a place is still to be chosen do not count",
        CostClass.BEFORE,
    ),
    OracleEntry(
        "parts",
        "does a place of a thing lie within a region where a goal of it holds?",
        "planner.tasking.facts",
        ("within/3",),
        "the outline at the place lies within the region, so that the region cannot be refuted without the place",
        CostClass.BEFORE,
    ),
    OracleEntry(
        "spots",
        "where can a thing lie out of the way, or within the region of its goal?",
        "planner.oracles.spots",
        ("place/2", "aside/2"),
        "the thing, not turned, lies there on free squares, and can be pushed there by itself",
        CostClass.WHEN_IN_WAY,
    ),
    OracleEntry(
        "carry",
        "can a thing be brought to a place, as things lie then, and where does everything lie afterwards?",
        "planner.oracles.carry",
        ("estimate/4", "hoped/3", "refuted/4", "given/3", "stood/2", "shut/2"),
        "a way by exact first contact; a refutation: none was found over all that is not known to be occupied, and "
        "without any one of its circumstances there is one",
        CostClass.LAZY,
    ),
    OracleEntry(
        "arrive",
        "can the robot walk to some squares, as things lie then?",
        "planner.oracles.carry",
        ("estimate/4", "hoped/3", "refuted/4", "given/3", "stood/2", "shut/2"),
        "a way from square to square over free ones",
        CostClass.LAZY,
    ),
)
