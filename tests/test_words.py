"""What tests hold and what readers read: few asserts on phrases, plain words in the docs.

A phrase is a string of two words or more. An assert that compares one, or searches one in a text,
holds a wording. Error lines are held whole and are not counted: they name a field and say ``got``,
or they come from a refusal.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
MOST_PHRASES = 39

PHRASE = re.compile(r"[^\W\d_]{2,}[,;:]? +[^\W\d_]{2,}")
ERROR_LINE = re.compile(r": got\b|^got |^(error|warning|interrupted): |; allowed ")
ERROR_NAME = re.compile(r"err|exception|caught|refus|failing|message|complain", re.IGNORECASE)
SEARCHES = {
    *("startswith", "endswith", "index", "count"),
    *("search", "match", "fullmatch", "partition"),
}


def comparisons(test: ast.expr) -> Iterator[tuple[ast.expr, list[ast.expr]]]:
    """Every comparison or search in an assert, with what it compares."""
    for node in ast.walk(test):
        if isinstance(node, ast.Compare):
            yield node, [node.left, *node.comparators]
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and node.func.attr in SEARCHES
        ):
            yield node, [node.func.value, *node.args]


def texts(node: ast.AST) -> Iterator[str]:
    """The strings that are compared themselves, those in lists and tables among them."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        parts = (str(p.value) if isinstance(p, ast.Constant) else "0" for p in node.values)
        yield "".join(parts)
    elif isinstance(node, ast.List | ast.Tuple | ast.Set | ast.Dict | ast.Starred | ast.BinOp):
        for child in ast.iter_child_nodes(node):
            yield from texts(child)


def phrases(test: ast.expr) -> list[str]:
    """The phrases of an assert that are no error lines."""
    found = []
    for node, compared in comparisons(test):
        said = [text for one in compared for text in texts(one) if PHRASE.search(text)]
        names = [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]
        names += [n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)]
        if not any(map(ERROR_NAME.search, names)):
            found += [text for text in said if not ERROR_LINE.search(text)]
    return found


def asserts_on_phrases(folder: Path) -> list[str]:
    """Place and phrase of every assert below ``folder`` that holds a wording."""
    return [
        f"{path.relative_to(ROOT)}:{node.lineno}: {held[0]!r}"
        for path in sorted(folder.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Assert) and (held := phrases(node.test))
    ]


def test_few_asserts_hold_a_phrase() -> None:
    found = asserts_on_phrases(ROOT / "tests")
    assert len(found) <= MOST_PHRASES, "\n".join(found)


def test_the_counter_itself() -> None:
    def held(source: str) -> bool:
        (node,) = ast.parse(source).body
        assert isinstance(node, ast.Assert)
        return phrases(node.test) != []

    holding = (
        "assert 'the pair is jammed' in text",
        "assert title == 'Key results'",
        "assert any('two regimes' in one for one in texts)",
        "assert said.startswith('In short, ')or said.endswith('at the end')",
        "assert [row.name for row in rows] == ['least', 'at the end']",
        "assert f'at {speed} the pair jams' in text",
    )
    free = (
        "assert 'jammed' in text",
        "assert numbers(text) == [1.0, 2.0]",
        "assert rows['at the end'] == 2",
        "assert said == 'teeth: got 3 wheels; allowed 5..2000'",
        "assert 'no such file' in str(caught.value)",
        "assert len(text) > 3, 'too few of them'",
    )
    assert [line for line in holding if not held(line)] == []
    assert [line for line in free if held(line)] == []


PLAIN = {
    "swing": "peak-to-peak",
    "swings": "peak-to-peak",
    "stands": "is, is given, is shown",
    "stand in": "replace",
    "as drawn": "of the drawing's sizes",
}
"""Words that docs and docstrings leave out, with those that they use."""
READ = ("README.md", "docs/*.md", "docs/howto/*.md", "docs/theory/*.md", "docs/tutorials/*.md")
RECORDS = re.compile(r"^(trial_|mutation|benchmarks|friction_evidence|licences|house)")
FLOORS = ["base", "case", "gears", "heat", "mesh", "dynamics", "analysis", "signals", "measured"]


def prose_of_docs() -> Iterator[tuple[str, str]]:
    """Path and text of every page that is written by hand."""
    for pattern in READ:
        for path in sorted(ROOT.glob(pattern)):
            if not RECORDS.match(path.name):
                yield str(path.relative_to(ROOT)), path.read_text("utf-8")


def prose_of_docstrings() -> Iterator[tuple[str, str]]:
    """Path and docstrings of every public module; compiled kernels explain themselves to few."""
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef
    for floor in FLOORS:
        for path in sorted((ROOT / "src" / "thermogear" / floor).rglob("*.py")):
            if "kernels" in path.parts:
                continue
            tree = ast.parse(path.read_text("utf-8"))
            docs = [ast.get_docstring(n) or "" for n in ast.walk(tree) if isinstance(n, kinds)]
            yield str(path.relative_to(ROOT)), "\n".join(docs)


def test_docs_and_docstrings_use_plain_words() -> None:
    found = [
        f"{path}: {word!r}; write {better}"
        for path, text in [*prose_of_docs(), *prose_of_docstrings()]
        for word, better in PLAIN.items()
        if re.search(rf"(?<![`_\w]){word}\b(?!_)", text)
    ]
    assert found == []
