"""The record of a run, read back from its lines."""

import pytest

from utak.kb.evidence.inputs import Given, input_reason
from utak.kb.evidence.reason import ReasonKind
from utak.kb.evidence.record import Record
from utak.kb.tracing.decisions import SolverCall


def test_the_places_of_a_long_run_are_those_of_its_steps_since_all_were_given_anew() -> None:
    count, anew = 3000, 1000
    lines = [
        {"step": n, "action": None, "retina": [], "touch": [], "why": "", "belief": {"place": [n, 0.5]}}
        for n in range(count)
    ]
    lines[anew]["belief"] = {"place": [anew, 0.5], "seen_from": [[-n, 0.0] for n in range(anew + 1)]}
    places = Record(lines).steps[-1].places
    assert places == (*((-n, 0.0) for n in range(anew + 1)), *((n, 0.5) for n in range(anew + 1, count)))


@pytest.mark.parametrize("atom", ["connects(d1,before_d1,behind_d1)", "width(d1,300)"])
def test_what_no_fact_states_of_a_door_is_supposed_and_not_measured(atom: str) -> None:
    given = Given(atom, SolverCall("task", (atom,), ()), 0)
    assert input_reason(Record(()), given, lambda _fact, _step: None).kind == ReasonKind.DECIDED
    lies = Given("lies(o1,g1_r2,r2)", given.call, 0)
    assert input_reason(Record(()), lies, lambda _fact, _step: None).kind == ReasonKind.MEASURED
