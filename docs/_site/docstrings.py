"""Plain-text docstrings as pages: formulas apart, examples as they are, bars and stars plain."""

from __future__ import annotations

import re
from typing import Any

import thermogear

# words of prose, as against symbols and the names of functions
_FUNCTIONS = {
    "sqrt", "asinh", "acosh", "atan", "tanh", "cosh", "sinh", "conj", "diag", "sign", "with",
    "mean", "time", "where", "else", "over", "from", "sum", "alpha", "beta", "gamma", "theta",
    "lambda", "omega", "sigma", "delta", "zeta",
}  # fmt: skip
_LEFT = re.compile(r"^[^\s=][^=]{0,44}?(?: = | <= | >= | < | > | -> | ~ )")
_SPLIT = re.compile(r"(``.+?``|:[a-z:]+:`[^`]+`|`[^`]+`(?:__?)?|https?://\S+)")


def _is_formula(line: str) -> bool:
    """A line of symbols with a relation, and next to no prose."""
    text = line.strip()
    if "``" in text or ":`" in text or not _LEFT.match(text):
        return False
    left = _LEFT.match(text)
    assert left is not None
    names = re.findall(r"\b[A-Za-z]{4,}\b", re.sub(r"[a-z]+\(", "(", left[0]).replace("_", " "))
    if any(name.lower() not in _FUNCTIONS for name in names):
        return False
    words = [w for w in re.findall(r"\b[A-Za-z]{4,}\b", text) if w.lower() not in _FUNCTIONS]
    symbols = len(re.findall(r"[=+*/^()\[\]]", text))
    return len(words) <= symbols / 4


def _escaped(line: str) -> str:
    """Bars, stars and trailing underscores mean themselves outside markup."""
    parts = _SPLIT.split(line)
    for place in range(0, len(parts), 2):
        text = parts[place].replace("\\", "\\\\")
        text = re.sub(r"([|*])", r"\\\1", text)
        parts[place] = re.sub(r"(?<=\w)_(?=\W|$)", r"\\_", text)
    return "".join(parts)


def as_pages(lines: list[str]) -> list[str]:
    """The docstring's lines in reStructuredText."""
    made: list[str] = []
    formula = example = False
    for number, line in enumerate(lines):
        example = line.strip() != "" and (example or line.lstrip().startswith(">>> "))
        if example:
            made.append(line)
            continue
        continues = (
            formula
            and line.strip() != ""
            and (line.startswith(" ") or re.match(r"^[-+*/=(\[]", line.strip()) is not None)
        )
        if continues or (number and _is_formula(line)):
            if not formula:
                made += ["", ".. code-block:: none", ""]
            made.append("   " + line.rstrip())
            formula = True
            continue
        if formula:
            made.append("")
        formula = False
        made.append(_escaped(line))
    return made


def _process(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    lines[:] = as_pages(lines)


def _public(app: Any, env: Any, node: Any, contnode: Any) -> Any:
    """``thermogear.run`` and the other public names lead to where they are defined."""
    name = str(node.get("reftarget", "")).removeprefix("thermogear.")
    home = thermogear._HOME.get(name)
    if home is None or node.get("refdomain") != "py":
        return None
    domain = env.get_domain("py")
    place = node.get("refdoc", env.docname)
    return domain.resolve_xref(env, place, app.builder, "obj", f"{home}.{name}", node, contnode)


_HOMES = {
    "Progress": "thermogear.base.progress.Progress",
    "Result": "thermogear.results.result.Result",
}
"""Names of the command line's signatures that other floors have too."""


def _signature(app: Any, what: str, name: str, *rest: Any) -> tuple[str | None, str | None] | None:
    """Signatures whose names are imported for type checkers alone, by their homes."""
    signature, returned = rest[-2:]
    if not name.startswith("thermogear.front.") or signature is None:
        return None
    for short, home in _HOMES.items():
        signature = re.sub(rf"(?<![\w.]){short}\b", home, signature)
    return signature, returned


def setup(app: Any) -> dict[str, Any]:
    app.connect("autodoc-process-docstring", _process)
    app.connect("autodoc-process-signature", _signature)
    app.connect("missing-reference", _public)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
