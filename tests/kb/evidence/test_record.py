"""The record of a run, read back from its lines."""

from utak.kb.evidence.record import Record


def test_the_places_of_a_long_run_are_those_of_its_steps_since_all_were_given_anew() -> None:
    count, anew = 3000, 1000
    lines = [
        {"step": n, "action": None, "retina": [], "touch": [], "why": "", "belief": {"place": [n, 0.5]}}
        for n in range(count)
    ]
    lines[anew]["belief"] = {"place": [anew, 0.5], "seen_from": [[-n, 0.0] for n in range(anew + 1)]}
    places = Record(lines).steps[-1].places
    assert places == (*((-n, 0.0) for n in range(anew + 1)), *((n, 0.5) for n in range(anew + 1, count)))
