"""The site's pages without building it: links, tables of contents, commands, names, numbers."""

from __future__ import annotations

import ast
import fnmatch
import functools
import importlib
import json
import posixpath
import re
import runpy
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from thermogear.base.notice import catalogue
from thermogear.front.cli import cli, main
from thermogear.thesis.report import CLAIMS

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))

from _site import pages  # noqa: E402

OUTSIDE = ("http://", "https://", "mailto:")
FENCE = re.compile(r"^ *(?P<fence>```+|::::*|~~~+)(?P<kind>[^\n`]*)\n(?P<body>.*?)^ *(?P=fence) *$", re.M | re.S)  # fmt: skip  # noqa: E501
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?\s*\)")


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    """Every page of the site by its path under docs/, and the files beside it at the root."""
    found = {
        str(file.relative_to(DOCS)): file.read_text("utf-8")
        for file in DOCS.rglob("*.md")
        if not {"_build", "generated", "jupyter_execute"} & set(file.relative_to(DOCS).parts)
    }
    for maker in pages.MAKERS:
        found |= maker()
    found["../README.md"] = (ROOT / "README.md").read_text("utf-8")
    return found


def _beside(page: str, path: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), path))


def _slug(heading: str) -> str:
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.replace("`", ""))
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def _prose(text: str) -> str:
    return FENCE.sub("", text)


def _anchors(text: str) -> set[str]:
    plain = _prose(text)
    marked = set(re.findall(r"^\(([^)]+)\)=", plain, re.M))
    return marked | {_slug(h) for h in re.findall(r"^#+ (.+)$", plain, re.M)}


def test_every_local_link_leads_somewhere(texts: dict[str, str]) -> None:
    wrong = []
    for page, text in texts.items():
        if not page.endswith(".md"):
            continue
        plain = re.sub(r"`[^`\n]*`", "", _prose(text))
        for target in LINK.findall(plain):
            if target.startswith(OUTSIDE):
                continue
            file, _, anchor = target.partition("#")
            place = _beside(page, file) if file else page
            if place not in texts and not (DOCS / place).exists():
                wrong.append(f"{page}: {target}")
            elif anchor and place in texts and anchor not in _anchors(texts[place]):
                wrong.append(f"{page}: {target} (no such heading)")
    assert wrong == []


def _entries(page: str, text: str) -> Iterator[str]:
    if page.endswith(".rst"):
        blocks = re.findall(r"^\.\. toctree::\n(?:   :.*\n)*\n((?:   \S.*\n)+)", text, re.M)
    else:
        blocks = [m["body"] for m in FENCE.finditer(text) if m["kind"].strip() == "{toctree}"]
    for block in blocks:
        for line in block.splitlines():
            entry = line.strip()
            if entry and not entry.startswith(":"):
                yield _beside(page, entry)


def test_every_page_is_in_one_table_of_contents(texts: dict[str, str]) -> None:
    known = {re.sub(r"\.(md|rst)$", "", page) for page in texts} - {"../README", "index"}
    listed = [
        name
        for page, text in texts.items()
        for entry in _entries(page, text)
        for name in (fnmatch.filter(known, entry) if "*" in entry else [entry])
    ]
    alone = {
        re.sub(r"\.md$", "", page)
        for page, text in texts.items()
        if re.match(r"---\n(?:.*\n)*?orphan: true\n", text)
    }
    assert len(listed) == len(set(listed))
    assert known - alone <= set(listed) <= known


def _command_lines(text: str) -> Iterator[str]:
    shells = [
        m["body"]
        for m in FENCE.finditer(text)
        if re.match(r"(sh|bash|powershell|console)", m["kind"])
    ]
    cells = re.findall(r"^!(.*)$", text, re.M)
    spans = re.findall(r"`([^`\n]+)`", _prose(text))
    lines = [line for body in shells for line in body.replace("\\\n", " ").splitlines()]
    for line in (*lines, *cells, *spans):
        found = re.match(r"\s*(?:\.venv[/\\](?:bin|Scripts)[/\\])?thermogear(?:\s+(.*))?$", line)
        if found and found[1]:
            yield re.split(r"\s[#>|]|\s2>", found[1])[0]


def _refusal(line: str) -> str:
    """Why the command line is none; "" when it is one."""
    words = shlex.split(line)
    command: click.Command = cli
    if words[0] == "...":
        return ""
    context = click.Context(cli, info_name="thermogear")
    while isinstance(command, click.Group) and words and not words[0].startswith("-"):
        if words[0] not in command.commands:
            return f"no command {words[0]!r}"
        command = command.commands[words.pop(0)]
        context = click.Context(command, parent=context)
    try:
        command.make_parser(context).parse_args(args=words)
    except click.UsageError as error:
        return error.format_message()
    return ""


def test_every_command_shown_exists_with_its_options(texts: dict[str, str]) -> None:
    shown = [
        (page, line)
        for page, text in texts.items()
        if page.endswith(".md")
        for line in _command_lines(text)
    ]
    assert len(shown) > 30
    wrong = [f"{page}: {line}: {why}" for page, line in shown if (why := _refusal(line))]
    assert wrong == []


def _exists(name: str) -> bool:
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            thing = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[count:]:
            if not hasattr(thing, attribute):
                return attribute in getattr(thing, "__annotations__", {})
            thing = getattr(thing, attribute)
        return True
    return False


def test_every_name_of_the_package_exists(texts: dict[str, str]) -> None:
    own = {page: text for page, text in texts.items() if page.endswith(".md")}
    named = {
        (page, name)
        for page, text in own.items()
        for name in re.findall(r"\bthermogear(?:\.[A-Za-z_]\w*)+", text)
    }
    imports = {
        (page, f"{home}.{name.split(' as ')[0].strip()}")
        for page, text in own.items()
        for home, names in re.findall(r"from (thermogear[\w.]*) import \(?([\w ,]+)", text)
        for name in names.split(",")
        if name.strip()
    }
    files = {"thermogear.front.cli", "thermogear.toml"}
    wrong = [f"{p}: {n}" for p, n in sorted(named | imports) if n not in files and not _exists(n)]
    assert wrong == []


def test_every_file_and_test_named_exists(texts: dict[str, str]) -> None:
    wrong = []
    for page, text in texts.items():
        for file in re.findall(r"\b(?:src|tests)/[\w/]+\.\w+", text):
            if not (ROOT / file).exists():
                wrong.append(f"{page}: {file}")
        for file, name in re.findall(r"`([\w/]+\.py)`?(?:::|` `)(test_\w+)", text):
            if name not in _tests(ROOT / "tests" / file):
                wrong.append(f"{page}: {file}::{name}")
    assert wrong == []


@functools.cache
def _tests(file: Path) -> dict[str, set[str]]:
    """Names of the tests of a file and what fixtures each asks for."""
    if not file.exists():
        return {}
    return {
        node.name: {argument.arg for argument in node.args.args}
        for node in ast.walk(ast.parse(file.read_text("utf-8")))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def test_the_validation_page_is_that_of_the_tests() -> None:
    stored = json.loads((DOCS / "validation.json").read_text("utf-8"))["entries"]
    noted = {one["test"].split("[")[0].replace("::", " ").split()[-1] for one in stored}
    comparing = {
        name
        for file in (ROOT / "tests").rglob("test_*.py")
        for name, fixtures in _tests(file).items()
        if "compared" in fixtures
    }
    assert noted == comparing, "run `make validation`"
    assert all(0.0 <= one["worst"] <= one["tolerance"] for one in stored)
    assert len(stored) >= 40


def test_the_page_of_notices_has_every_code_with_what_to_do(texts: dict[str, str]) -> None:
    lines = texts["generated/notices.md"].splitlines()
    rows = [line.strip("| ").split(" | ") for line in lines if line.startswith("| `")]
    assert sorted(code.strip("`") for code, _, _ in rows) == list(catalogue())
    for code, sentence, to_do in rows:
        entry = catalogue()[code.strip("`")]
        assert to_do.replace("\\*", "*") == entry.to_do
        assert all(
            f"*{name}*" in sentence for name in entry.fields if f"{{{name}|" not in entry.sentence
        )
        assert not re.search(r"[{}\[\]]", sentence)


def test_the_claims_shown_are_those_of_the_package() -> None:
    stored = json.loads((DOCS / "thesis.json").read_text("utf-8"))["claims"]
    assert [(one["number"], one["words"]) for one in stored] == [
        (claim.number, claim.words) for claim in CLAIMS
    ], "run `make validation`"


RAN: set[str] = set()
"""Lines that ran: those of the README are shown on another page too."""


def _blocks(page: str) -> str:
    text = (DOCS / page).read_text("utf-8")
    return "\n".join(m["body"] for m in FENCE.finditer(text) if m["kind"] == "python")


@pytest.mark.slow
@pytest.mark.usefixtures("warmed_once")
@pytest.mark.parametrize(
    "page",
    ["../README.md", "start.md", *(f"howto/{p.name}" for p in (DOCS / "howto").glob("*.md"))],
)
def test_python_shown_runs(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code = _blocks(page)
    if not code or code in RAN:
        return
    monkeypatch.chdir(tmp_path)
    assert main(["example", "rig"]) == 0
    (tmp_path / "mine.toml").write_text(capsys.readouterr().out, "utf-8")
    (tmp_path / "shown.py").write_text(code, "utf-8")
    runpy.run_path(str(tmp_path / "shown.py"))
    assert capsys.readouterr().out.strip()
    RAN.add(code)


@pytest.mark.slow
def test_the_answers_shown_are_those_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The first pair of the start page with some of its answers; the README shows some, too."""
    page = (DOCS / "start.md").read_text("utf-8")
    shown = next(m["body"] for m in FENCE.finditer(page) if m["kind"] == "text")
    commands = next(m["body"] for m in FENCE.finditer(page) if "thermogear new" in m["body"])
    monkeypatch.chdir(tmp_path)
    for line in commands.splitlines():
        capsys.readouterr()
        assert main(shlex.split(line)[1:]) == 0
    printed = set(capsys.readouterr().out.splitlines())
    readme = (ROOT / "README.md").read_text("utf-8")
    some = next(m["body"] for m in FENCE.finditer(readme) if m["kind"] == "text")
    assert len(shown.splitlines()) >= 10
    assert set(shown.splitlines()) <= printed, "copy the answers into the start page again"
    assert set(some.splitlines()) <= printed
