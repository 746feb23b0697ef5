"""The docs are true: pages made from the code are fresh, links lead somewhere, modules exist, and commands run."""

import io
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests.laws import in_house
from tests.tables import few
from utak.simulator.cli.main import main

ROOT = Path(__file__).resolve().parent.parent
PAGES = sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").rglob("*.md"))
WRITTEN = [page for page in PAGES if page.parent.name != "reference" and page.name != "CHANGELOG.md"]
QUICK = [ROOT / "docs" / "replay.md", *(ROOT / "docs" / "guides").glob("*.md")]  # pages that take few seconds
PACKAGES = "geometry|kb|planner|simulator|utak|benchmarks"


def named(page: Path) -> str:
    """Return a page's path below the root."""
    return page.relative_to(ROOT).as_posix()


def test_the_pages_made_from_the_code_are_fresh() -> None:
    command = [sys.executable, str(ROOT / "docs" / "build_reference.py"), "--check"]
    found = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert found.returncode == 0, found.stderr


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_links_lead_somewhere(page: Path) -> None:
    for link, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([\w-]+))?\)", page.read_text()):
        target = page.parent / link if link else page
        assert target.exists(), link
        if anchor and target.suffix == ".md":
            titles = re.findall(r"^#+ (.*)$", target.read_text(), re.MULTILINE)
            assert anchor in {re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles}, anchor


@pytest.mark.parametrize("page", WRITTEN, ids=named)
def test_modules_and_files_that_a_page_names_exist(page: Path) -> None:
    text = page.read_text()
    for dotted in re.findall(rf"(?<![\w/.-])((?:{PACKAGES})(?:\.(?!md\b|py\b|lp\b)[a-z_0-9]+)+)", text):
        assert known(dotted), dotted
    for path in re.findall(rf"(?<![\w/.])((?:{PACKAGES}|tests|docs|examples|\.ci)/[\w/.-]*[\w/])", text):
        is_environment = path.startswith("utak/Tabletop-v")  # a name that Gymnasium knows, not a file
        assert is_environment or (ROOT / path).exists() or (page.parent / path).exists(), path


def test_what_is_to_be_installed_is_there() -> None:
    """Utak is in no registry: it is installed from a checkout, with its extras, and other packages by their names."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = set(project["optional-dependencies"])
    texts = [*WRITTEN, *(path for package in PACKAGES.split("|") for path in (ROOT / package).rglob("*.py"))]
    found = [one for path in texts for one in re.findall(r"pip install ([^`\n]*)", path.read_text(encoding="utf-8"))]
    assert any("-e " in one for one in found)
    for one in found:
        assert "utak" not in one.split("&&")[0].casefold(), one
        assert set(re.findall(r"\.\[(\w+)\]", one)) <= extras, one


def known(dotted: str) -> bool:
    """Return whether a dotted name is a package or module of ours, or something that stands in one."""
    parts = in_house(dotted).split(".")
    for length in range(len(parts), 0, -1):
        path = ROOT.joinpath(*parts[:length])
        if path.with_suffix(".py").exists():
            rest = parts[length:]
            return (
                not rest
                or re.search(rf"^\s*(?:def|class) {rest[0]}\b|^{rest[0]}\b", path.with_suffix(".py").read_text(), re.M)
                is not None
            )
        if path.is_dir():
            return length == len(parts)
    return False


def fences(page: Path, kind: str) -> list[str]:
    """Return the fenced blocks of one kind on a page."""
    return re.findall(rf"^```{kind}\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)


def pages(kind: str) -> list[Any]:
    """Return the pages with blocks of a kind, of which the quick ones are tried by default."""
    shown = [page for page in WRITTEN if fences(page, kind)]
    return few(shown, set(QUICK) & set(shown))


@pytest.mark.long
@pytest.mark.parametrize("page", pages("console"), ids=named)
def test_commands_of_a_page_do_what_it_shows(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run the `console` blocks: commands of `utak` after "$ ", below each what it prints; "..." stands for anything."""
    for name in ("examples", "docs"):
        (tmp_path / name).symlink_to(ROOT / name, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    for block in fences(page, "console"):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, printed = part.partition("\n")
            words = shlex.split(command, comments=True)
            if words[0] == "cat":  # a file that the reader writes
                Path(words[2]).write_text(printed)
                continue
            assert words[0] == "utak", command
            assert main(words[1:]) in (0, 1), command
            seen = capsys.readouterr().out
            shown = ".*".join(re.escape(piece) for piece in printed.split("..."))
            assert not printed or re.fullmatch(shown, seen, re.DOTALL), f"{command}\n{seen}"


@pytest.mark.parametrize("page", pages("python"), ids=named)
def test_programs_of_a_page_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The `python` blocks of a page are one program; their asserts hold."""
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    program = "\n".join(fences(page, "python"))
    exec(compile(program, str(page), "exec"), {"__name__": "docs"})


@pytest.mark.parametrize("page", WRITTEN, ids=named)
def test_benchmarks_that_a_page_names_have_the_options_it_shows(page: Path) -> None:
    for module, rest in re.findall(r"python -m (benchmarks[\w.]*)([^`\n]*)", page.read_text()):
        path = ROOT.joinpath(*module.split("."))
        program = path / "__main__.py" if path.is_dir() else path.with_suffix(".py")
        assert program.exists(), module
        sources = "".join(p.read_text() for p in [program, *(path.glob("*.py") if path.is_dir() else [])])
        kinds = {"--plain", "--snug", "--loose"} if "add_kinds" in sources else set[str]()
        for option in re.findall(r"(?<![\w-])(--[\w-]+)", rest.split("#")[0]):
            assert f'"{option}"' in sources or option in kinds, f"{module} {option}"


def test_the_conversation_at_the_prompt_goes_as_the_page_shows(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Type what stands behind `utak N>` in docs/asking.md; what is printed stands below it."""
    monkeypatch.chdir(ROOT)
    block = (ROOT / "docs" / "asking.md").read_text().partition("    $ utak repl ")[2].partition("\n\n")[0]
    scenario, *rest = [line.removeprefix("    ") for line in block.splitlines()]
    typed = [re.sub(r"^utak \d+> ", "", line) for line in rest if re.match(r"utak \d+> ", line)]
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO("\n".join([*typed, ""]).encode())))
    assert main(["repl", scenario]) == 0
    assert capsys.readouterr().out.splitlines() == [line for line in rest if not re.match(r"utak \d+> ", line)]
