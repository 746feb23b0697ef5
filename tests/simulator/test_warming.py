"""What is compiled before the first run."""

import sys

from simulator import warming


def test_each_use_works_by_itself() -> None:
    for use in {use for halves in warming.HALVES.values() for half in halves for use in half}:
        use()


def test_two_processes_share_the_work() -> None:
    walking, carrying = ([use for half in warming.HALVES[kind] for use in half] for kind in (False, True))
    assert len(set(walking)) == len(walking)
    assert len(set(carrying)) == len(carrying)
    assert set(carrying) - set(walking) == {warming.carry}
    assert set(walking) <= set(carrying)


def test_the_other_process_does_what_it_is_told(monkeypatch) -> None:
    done = []
    monkeypatch.setattr(warming, "compile_for", done.extend)
    for halves in warming.HALVES.values():
        done.clear()
        warming.main([use.__name__ for use in halves[1]])
        assert sorted(done, key=repr) == sorted(halves[1], key=repr)


def test_the_first_run_says_what_it_does(monkeypatch) -> None:
    told, done = [], []
    monkeypatch.setattr(warming, "cold", lambda: True)
    monkeypatch.setattr(warming, "tell", lambda: told.append(True))
    monkeypatch.setattr(warming, "compile_for", done.extend)
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    warming.warm(carrying=False)
    assert told
    assert done == list(warming.HALVES[False][0])
    monkeypatch.setattr(warming, "cold", lambda: False)
    warming.warm(carrying=True)
    assert len(told) == 1


def test_bytecode_is_kept_where_python_keeps_none(monkeypatch, tmp_path) -> None:
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "module.py").write_text("ANSWER = 42\n")
    (tmp_path / "broken.py").write_text("ANSWER =\n")
    monkeypatch.setattr(warming, "PACKAGES", [tmp_path, tmp_path / "absent"])
    monkeypatch.setattr(warming, "cold", lambda: True)
    monkeypatch.setattr(warming, "tell", lambda: None)
    monkeypatch.setattr(warming, "compile_for", lambda _: None)
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    for told, kept in ((False, 0), (True, 1)):
        monkeypatch.setattr(sys, "dont_write_bytecode", told)
        warming.warm(carrying=False)
        assert len(list(tmp_path.rglob("module.*.pyc"))) == kept


def test_every_package_of_the_robot_is_among_those_whose_bytecode_is_kept() -> None:
    assert all((package / "__init__.py").is_file() for package in warming.PACKAGES)
