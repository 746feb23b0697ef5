"""Episodes as sequences of steps: beliefs, questions, reasons, and how they show themselves."""

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest

import utak
from utak.beliefs import MAX_ROWS_SHOWN, Answer

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.fixture(scope="module")
def episode() -> utak.Episode:
    return utak.Run(utak.Scenario.read(EXAMPLES / "push_l_next_room")).finish()


def test_an_episode_is_a_sequence_of_steps(episode: utak.Episode) -> None:
    numbers = list(range(len(episode)))
    assert [step.number for step in episode] == numbers
    assert [step.number for step in episode[2:5]] == [2, 3, 4]
    assert episode[-1].number == numbers[-1]
    assert episode[0].action == "wake"
    assert {step.held for step in episode} > {None}
    with pytest.raises(IndexError, match=f"there is no step {len(episode)}: the last is {len(episode) - 1}"):
        episode[len(episode)]
    assert repr(episode) == f"<Episode of {len(episode) - 1} commands; done: {episode.reason}>"


def test_beliefs_are_asked_at_any_step(episode: utak.Episode) -> None:
    assert not episode[0].world.query("shape(X, l_shape, C), C > 90")
    answer = episode.world.query("shape(X, l_shape, C), C > 90")
    assert answer
    assert len(answer) == len(list(answer)) == 1
    (row,) = answer
    assert set(row) == {"X", "C"}
    assert episode.world.query("held(o1)").kind in ("yes", "no", "don't know")
    assert f"shape({row['X']}, l_shape, {row['C']})" in episode.world
    assert episode.world.bound == {"x": row["X"]}
    with pytest.raises(utak.BadInputError, match="query:1:"):
        episode.world.query("shape(X,")


def test_reasons_are_given(episode: utak.Episode) -> None:
    verdict = episode.why("verdict(done)")
    assert verdict.claim == "verdict(done)"
    assert str(verdict).count("\n") >= 1
    assert verdict.text("short") == str(verdict).splitlines()[0]
    assert verdict.as_dict()["claim"] == "verdict(done)"
    assert "<details open=" in verdict._repr_html_()
    assert episode.why("shape(X, l_shape, C)", 5).claim.startswith("shape(o1,l_shape,")
    assert "cell 3" in episode.why_cell(3).claim
    assert "command" in episode[1].explain().claim
    with pytest.raises(utak.BadInputError):
        episode.why("shape(o77, square, 99)")
    with pytest.raises(ValueError, match="deep"):
        verdict.text("deep")


def test_an_episode_that_was_cut_short_has_no_verdict(episode: utak.Episode, tmp_path: Path) -> None:
    path = tmp_path / "run.jsonl"
    episode.save(path)
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:3]))
    short = utak.Episode.read(path)
    assert (len(short), short.verdict, short.reason, short.achieved) == (2, None, "", None)
    assert repr(short) == "<Episode of 1 command; cut short>"
    short.save(path)
    assert utak.Episode.read(path).record == short.record


def test_a_file_of_another_kind_is_not_overwritten(episode: utak.Episode, tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("notes")
    with pytest.raises(utak.CannotOpenError, match="is no episode"):
        episode.save(path)
    assert path.read_text() == "notes"
    episode.save(path, force=True)
    assert utak.Episode.read(path).record == episode.record


def shown(episode: utak.Episode) -> Iterator[str]:
    """Yield all that shows itself as SVG or HTML."""
    yield episode._repr_svg_()
    yield episode[3]._repr_svg_()
    yield episode[3].world._repr_svg_()
    yield episode._repr_html_()
    yield episode[3]._repr_html_()
    yield episode[3].world._repr_html_()
    yield episode.world.query("shape(X, S, C)")._repr_html_()
    yield episode.world.query("held(o1)")._repr_html_()


def test_all_is_shown_as_well_formed_markup_without_scripts(episode: utak.Episode) -> None:
    for markup in shown(episode):
        ElementTree.fromstring(f"<div>{markup}</div>")
        assert "<script" not in markup
        assert "http" not in markup.replace("http://www.w3.org/2000/svg", "")


def test_texts_of_an_episode_are_escaped(episode: utak.Episode) -> None:
    line = {**episode[1].line, "why": "<script>alert(1)</script>"}
    assert "<script" not in utak.Step(line, episode.record)._repr_html_()


def test_a_world_without_facts_can_be_shown() -> None:
    world = utak.World(0, (), {"facts": []})
    assert world
    assert len(world) == 0
    ElementTree.fromstring(world._repr_svg_())
    assert repr(world) == "<World at step 0: 0 facts; objects: none>"


def test_a_picture_shows_what_may_be_otherwise() -> None:
    ring = [(0, 0, 400, 0), (400, 0, 400, 300), (400, 300, 0, 0)]
    outline = [f"segment(o1,{n},{','.join(map(str, ends))},99)." for n, ends in enumerate(ring)]
    place = ("rect(o1,0,0,400,300).", "threshold(d1,0,0,0,500).", *outline)
    sure, doubt = (
        utak.World(0, (*place, *facts), {"facts": [], "place": [1, 1]})._repr_svg_()
        for facts in (("door(d1,99).", "kind(o1,object,97)."), ("door(d1,31).", "kind(o1,object,46)."))
    )
    for words in ("url(#doubt)", "o1 46 %", "d1 31 %", "dasharray"):
        assert words in doubt
        assert words not in sure
    ElementTree.fromstring(doubt)


def test_an_answer_says_how_many_rows_it_does_not_show() -> None:
    rows = tuple((number,) for number in range(MAX_ROWS_SHOWN + 1))
    for count, more, said in (
        (MAX_ROWS_SHOWN, False, None),
        (MAX_ROWS_SHOWN + 1, False, "<p>and 1 more row</p>"),
        (MAX_ROWS_SHOWN + 1, True, "<p>and 1 more row, and others that were not looked for</p>"),
        (2, True, "<p>and others that were not looked for</p>"),
    ):
        shown = Answer("bindings", ("X",), rows[:count], more)._repr_html_()
        assert shown.endswith(said) if said else "<p>" not in shown
