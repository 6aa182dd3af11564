"""The house in figures: floors, what each imports, public names. Prints docs/house.md.

``python checks/house.py > docs/house.md`` writes it anew; tests/test_house.py holds it true.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

import grimp

import thermogear

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "thermogear"
FLOORS = (
    "front", "views", "thesis", "study", "case", "mesh", "heat", "shafts", "gears",
    "measured", "analysis", "dynamics", "signals", "results", "base",
)  # fmt: skip


CHANGING = {
    "LoadedModel", "answers", "campbell", "drawing", "loaded_contact", "modes", "read_rexs",
    "sensitivity", "statics", "waterfall",
}  # fmt: skip
"""Public names whose arguments and stored names may change with any release."""


MOST_STATEMENTS = 40
"""Most statements of a function; above it, it does two things."""


def statements(tree: ast.AST) -> int:
    """Statements in ``tree``, without docstrings and the tree itself."""
    return sum(
        isinstance(node, ast.stmt)
        and node is not tree
        and not (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        )
        for node in ast.walk(tree)
    )


@cache
def trees() -> dict[Path, tuple[str, ast.Module]]:
    """File -> its text and its syntax tree."""
    texts = {path: path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py")}
    return {path: (text, ast.parse(text)) for path, text in texts.items()}


@cache
def graph() -> grimp.ImportGraph:
    """Which module imports which."""
    return grimp.build_graph("thermogear", cache_dir=None)


def sizes() -> dict[str, dict[str, int]]:
    """Floor -> modules, lines, statements, nodes of the syntax tree, functions above the limit."""
    found = {}
    for floor in (*FLOORS, "."):
        paths = (SOURCE / floor).glob("*.py" if floor == "." else "**/*.py")
        modules = [trees()[path] for path in paths]
        nodes = [node for _, tree in modules for node in ast.walk(tree)]
        functions = [n for n in nodes if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
        found[floor] = {
            "modules": len(modules),
            "lines": sum(len(text.splitlines()) for text, _ in modules),
            "statements": sum(statements(tree) for _, tree in modules),
            "nodes": len(nodes),
            "long functions": sum(statements(n) > MOST_STATEMENTS for n in functions),
        }
    return found


def imports() -> dict[str, list[str]]:
    """Floor -> the floors it imports, from the top down."""
    found: dict[str, set[str]] = defaultdict(set)
    for module in graph().modules:
        parts = module.split(".")
        if len(parts) > 1:
            for other in graph().find_modules_directly_imported_by(module):
                below = other.split(".")
                if len(below) > 1 and below[1] != parts[1]:
                    found[parts[1]].add(below[1])
    return {floor: [name for name in FLOORS if name in found[floor]] for floor in FLOORS}


def names() -> list[tuple[str, str, str]]:
    """(name, module, first sentence) of every public name."""
    found = []
    for name in thermogear.__all__:
        if name != "__version__":
            one = getattr(thermogear, name)
            words = " ".join((inspect.getdoc(one) or "").split("\n\n")[0].split())
            words = re.sub(r":\w+:`", "`", words)
            found.append((name, one.__module__.removeprefix("thermogear."), words))
    return found


def page() -> str:
    """The whole page as text."""
    lines = [
        "---", "orphan: true", "---", "# The house in figures", "",
        "Made by `make house`; a test holds it true. What the floors are for is in",
        "[the architecture](architecture.md). Imports only point down, without cycles;",
        "functions are short; every public name is loaded when first used.", "",
        f"Long functions have more than {MOST_STATEMENTS} statements.", "",
        "| floor | modules | lines | statements | nodes | long functions | imports |",
        "|---|---:|---:|---:|---:|---:|---|",
    ]  # fmt: skip
    below, counts = imports(), sizes()
    counts["all"] = {name: sum(c[name] for c in counts.values()) for name in counts["base"]}
    for floor, count in counts.items():
        figures = " | ".join(map(str, count.values()))
        lines.append(f"| `{floor}` | {figures} | {', '.join(below.get(floor, ()))} |")
    lines += [
        "", "## Public names", "",
        "What is not listed here is not public. A stable name keeps its arguments, units and",
        "stored names; where it must change, the change log says what to write instead. A changing",
        "one may differ with any release, and the change log says so.", "",
        "| name | where | stability | what it is |", "|---|---|---|---|",
    ]  # fmt: skip
    for name, module, words in names():
        kept = "changing" if name in CHANGING else "stable"
        lines.append(f"| `{name}` | `{module}` | {kept} | {words.replace('|', chr(92) + '|')} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
