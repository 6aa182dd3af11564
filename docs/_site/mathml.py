"""Formulas as MathML, which browsers draw by themselves: no script, nothing from outside."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert

_NAMED = re.compile(r"<mi>(a?(?:sin|cos|tan)h?|arccos|ln|log|exp|det|max|min|lim)</mi>")
_BAR = re.compile(r'<mo(?: stretchy="false")?>&#x0007C;</mo>')


def _convert(formula: str, display: str = "inline") -> str:
    """MathML with the room that named functions and bars want."""
    made = convert(formula, display=display)
    made = _NAMED.sub(r'<mo lspace="0.17em" rspace="0.17em">\1</mo>', made)
    return _BAR.sub('<mo stretchy="false" lspace="0.05em" rspace="0.05em">|</mo>', made)


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(f'<span class="math">{_convert(node.astext())}</span>')
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    anchors = "".join(f'<span id="{name}"></span>' for name in node.get("ids", ()))
    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    # a formula wider than the page is scrolled by itself, never the page
    body = _convert(node.astext(), "block")
    writer.body.append(f'<div class="math-block">{anchors}{number}{body}</div>\n')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
