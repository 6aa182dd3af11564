"""The limits of the answers, from the table that holds them."""

from __future__ import annotations

from _site.case_file import _cell
from thermogear.base.limits import LIMITS, PARTING, Limit

OF_THE_CASE = {
    "dynamic_factor": f"at most the K_v of ISO 6336-1 method B, where that is below {PARTING:g}",
    "transmission_error": "at most what the class allows of the flanks, and the load's share, ours",
}
"""Limits whose bound hangs on the case, in words."""

HEAD = """\
# Limits of the answers

What `thermogear answers` and the top of every report hold a number against. This page is made from
`thermogear.base.limits`, the only place where a limit stands. A limit is called *usual* where its
source is recalled and was not read, *ours* where it is a choice of this program. The verdict is
*fine* within the limit, *look here* outside, *not decided* where there is no number, or no limit.
[Read the answers](../howto/answers.md) says what to do then.

"""
ERROR = r"""
## Limit of the transmission error

Peak to peak, the sum of what manufacture and the load leave. Flanks within the tolerances of
ISO 1328-1 lead by at most $f_{H\alpha1} + f_{f\alpha1} + f_{H\alpha2} + f_{f\alpha2}$ without
load: slope and form of both gears, by their class, module and diameter. Most pairs of a class stay
well below; the answer tells what 64 pairs of it have. The load adds $\tfrac{3}{7}\,w/c'$, the
line load over the single stiffness of ISO 6336-1: with $c_\gamma = c'(0.75\varepsilon + 0.25)$ what
the step from one pair to two leaves at $\varepsilon = 2$, on flanks without relief.
"""


def _bound(name: str, limit: Limit) -> str:
    return OF_THE_CASE.get(name) or limit.words


def limits() -> dict[str, str]:
    """One row per limit, then how that of the transmission error is reckoned."""
    text = HEAD + "| number | limit | source |\n|---|---|---|\n"
    for name, limit in LIMITS.items():
        title = name.replace("_", " ")
        text += f"| {title} | {_cell(_bound(name, limit))} | {_cell(limit.source)} |\n"
    return {"generated/limits.md": text + ERROR}
