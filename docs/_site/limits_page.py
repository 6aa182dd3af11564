"""The limits of the answers, from the table that holds them."""

from __future__ import annotations

from _site.case_file import _cell
from thermogear.base.limits import LIMITS, USUAL_ERROR, Limit

OF_THE_CASE = {
    "dynamic_factor": "at most the K_v of ISO 6336-1 method B",
    "transmission_error": "at most what the class and the load usually leave, usual",
}
"""Limits whose bound hangs on the case, in words."""

HEAD = """\
# Limits of the answers

What `thermogear answers` and the top of every report hold a number against. This page is made from
`thermogear.base.limits`, the only place where a limit stands. A limit is called *usual* where its
source is recalled and was not read. The verdict is *fine* within the limit, *look here* outside,
*not decided* where there is no number. [Read the answers](../howto/answers.md) says what to do
then.

"""


def _bound(name: str, limit: Limit) -> str:
    return OF_THE_CASE.get(name) or limit.words


def limits() -> dict[str, str]:
    """One row per limit, then how the usual transmission error is reckoned."""
    text = HEAD + "| number | limit | source |\n|---|---|---|\n"
    for name, limit in LIMITS.items():
        title = name.replace("_", " ")
        text += f"| {title} | {_cell(_bound(name, limit))} | {_cell(limit.source)} |\n"
    known = "; ".join(f"class {grade}: {most:g} µm" for grade, most in USUAL_ERROR)
    text += (
        "\n## Usual transmission error\n\n"
        f"Peak to peak, without load: {known}; linear between, and constant beyond. The load adds "
        "$0.43\\,w/c'$, the line load over the single stiffness of ISO 6336-1: what the step from "
        "one pair to two leaves on flanks without relief.\n"
    )
    return {"generated/limits.md": text}
