"""What changed from the facts of one step to those of the next one."""

from hypothesis import given
from hypothesis import strategies as st

from utak.simulator.replay.changes import changes

FACTS = st.lists(
    st.builds(
        "{}({},{}).".format, st.sampled_from(["kind", "segment"]), st.sampled_from(["o1", "o2"]), st.integers(0, 5)
    ),
    unique=True,
)


@given(FACTS, FACTS)
def test_changes_account_for_every_fact_but_edges(before: list[str], after: list[str]) -> None:
    found = changes(before, after)
    gone = {*found.removed, *(old for old, _ in found.changed)}
    come = {*found.added, *(new for _, new in found.changed)}
    assert gone == {fact for fact in before if fact not in after and not fact.startswith("segment")}
    assert come == {fact for fact in after if fact not in before and not fact.startswith("segment")}
    edges = {fact for fact in set(before) ^ set(after) if fact.startswith("segment")}
    assert set(found.edges) == {fact[8:10] for fact in edges}


def test_names_that_hold_digits_are_no_numbers() -> None:
    found = changes(["kind(o1,object,20)."], ["kind(o2,object,20)."])
    assert (found.added, found.removed, found.changed) == (["kind(o2,object,20)."], ["kind(o1,object,20)."], [])
