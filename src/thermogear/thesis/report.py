"""Every claim judged, and the results that the judgements rest on, as one stored tree."""

from __future__ import annotations

import datetime
import json
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

import thermogear
from thermogear.base.progress import Progress, silent
from thermogear.base.units import RPM
from thermogear.results.files import claimed, write_results, write_summary
from thermogear.study.sensitivity import plain_words
from thermogear.thesis import section2, section3, section4, section5, section6
from thermogear.thesis.claim import Claim, Finding, Verdict
from thermogear.thesis.document import table
from thermogear.thesis.evidence import STAGES, Evidence, Size

CLAIMS: tuple[Claim, ...] = (
    *section2.CLAIMS,
    *section3.CLAIMS,
    *section4.CLAIMS,
    *section5.CLAIMS,
    *section6.CLAIMS,
)
"""Every claim of sections 2 to 6, in the document's order."""

TITLE = "The thesis, claim by claim"


def judge(evidence: Evidence) -> list[Finding]:
    """What the computation says of every claim, in order; of those before Ctrl+C if it comes.

    Ctrl+C is passed on where there is nothing yet that a page could show.
    """
    found: list[Finding] = []
    try:
        for claim in CLAIMS:
            found.append(claim.judge(evidence))
    except KeyboardInterrupt:
        if not (found and evidence.finished("tree")):
            raise
        return found
    evidence.progress(STAGES[-1], len(STAGES), len(STAGES))
    return found


def counts(findings: list[Finding]) -> dict[str, int]:
    """Verdict -> how many claims carry it, in the order of :class:`Verdict`."""
    number = Counter(finding.verdict for finding in findings)
    return {verdict.value: number[verdict] for verdict in Verdict}


def build(size: Size | None = None, progress: Progress = silent) -> xr.DataTree:
    """All evidence and every verdict as one tree of datasets; see :mod:`thermogear.thesis`.

    After Ctrl+C what was finished: fewer claims than ``claims_in_all`` in the attributes.
    """
    began = time.perf_counter()
    evidence = Evidence(Size() if size is None else size, progress)
    findings = judge(evidence)
    groups = dict(evidence.groups)
    groups["claims"] = _claims(findings)
    for name in filter(evidence.finished, ("grid", "flips", "warming")):
        groups[name] = getattr(evidence, name)
    if evidence.finished("comparison"):
        groups["experiment"] = _experiment(evidence)
    if evidence.finished("sensitivity"):
        groups["sensitivity"] = evidence.sensitivity.assign(
            sentence=(("output",), plain_words(evidence.sensitivity))
        )
    if evidence.finished("diagrams"):
        for name, data in evidence.diagrams.items():
            groups[f"diagrams/{name}"] = _plain(data)
    tree = xr.DataTree.from_dict(groups)
    tree.attrs = {
        **evidence.tree.attrs,
        "thermogear": thermogear.__version__,
        "title": TITLE,
        "kind": "thesis",
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "counts": json.dumps(counts(findings)),
        "claims_in_all": len(CLAIMS),
        "sentences": json.dumps(_sentences()),
        "seconds": time.perf_counter() - began,
    }
    return tree


def build_to_directory(
    directory: Path,
    size: Size | None = None,
    progress: Progress = silent,
    also: Callable[[Path], object] = lambda folder: None,
) -> dict[str, Any]:
    """:func:`build`, then ``results.nc`` and ``summary.json`` in ``directory``; the summary.

    ``also`` is called with the folder where both stand before they are put into ``directory``;
    what it writes there is put with them.
    """
    with claimed(directory) as folder:
        tree = build(size, progress)
        found = summary(tree)
        write_results(tree, folder)
        write_summary(found, folder)
        also(folder)
    return found


def summary(tree: xr.DataTree) -> dict[str, Any]:
    """Counts, verdicts and the ranking of the inputs, JSON-ready."""
    claims = tree["claims"].to_dataset()
    rows = [
        {name: str(claims[name].values[k]) for name in TEXTS} for k in range(claims.sizes["claim"])
    ]
    found = {
        "thermogear": tree.attrs["thermogear"],
        "title": tree.attrs["title"],
        "kind": "thesis",
        "claims": len(rows),
        "claims_in_all": int(tree.attrs["claims_in_all"]),
        "verdicts": json.loads(tree.attrs["counts"]),
        "sentences": json.loads(tree.attrs["sentences"]),
        "seconds": round(float(tree.attrs["seconds"]), 1),
        "rows": rows,
    }
    if "sensitivity" in tree:
        ranked = tree["sensitivity"].to_dataset()
        found["sensitivity"] = {
            "evaluations": int(ranked.attrs["evaluations"]),
            "seconds": round(float(ranked.attrs["seconds"]), 1),
            "results": [str(text) for text in ranked["sentence"].values],
        }
    return found


TEXTS = (
    "number",
    "place",
    "kind",
    "words",
    "as_in_the_thesis",
    "consistent",
    "verdict",
    "argument",
    "code",
    "picture",
)


def _claims(findings: list[Finding]) -> xr.Dataset:
    columns: dict[str, list[str]] = {name: [] for name in TEXTS}
    for claim, finding in zip(CLAIMS, findings, strict=False):
        row = (
            claim.number,
            claim.place,
            claim.kind,
            claim.words,
            finding.thesis,
            finding.consistent,
            finding.verdict.value,
            finding.argument,
            " ".join(claim.code),
            claim.picture,
        )
        for name, text in zip(TEXTS, row, strict=True):
            columns[name].append(text)
    return xr.Dataset({name: (("claim",), texts) for name, texts in columns.items()})


def _sentences() -> dict[str, int]:
    rows = table()
    return {"all": len(rows), "claimed": sum(bool(row.claims) for row in rows)}


def _plain(data: xr.Dataset) -> xr.Dataset:
    """A diagram without what its picture does not need."""
    kept = data[["label", "period", "lyapunov", "section_x"]]
    return kept.assign_attrs({k: v for k, v in data.attrs.items() if isinstance(v, str | int)})


def _experiment(evidence: Evidence) -> xr.Dataset:
    """The printed table beside what its entries give: errors, implied g and rpm."""
    found = evidence.comparison
    columns: dict[str, list[Any]] = {}
    implied = {item.speed: item for item in found.implied}
    for row in found.rows:
        scale = 1.0 if row.quantity == "frequency" else 1e6
        item = implied[row.speed]
        shaft = float("nan") if item.shaft_speed is None else item.shaft_speed / RPM
        line: dict[str, Any] = {
            "speed": row.speed,
            "quantity": row.quantity,
            "measured": row.measured * scale,
            "u_val": 100.0 * row.u_val,
            "implied_g": item.acceleration_g,
            "implied_rpm": shaft,
            "verdict": row.verdict,
        }
        for name, value, error, printed in zip(
            ("with", "without"), row.simulated, row.errors, row.printed, strict=True
        ):
            line |= {
                f"{name}_value": value * scale,
                f"{name}_error": 100.0 * abs(error),
                f"{name}_printed": printed,
            }
        for name, entry in line.items():
            columns.setdefault(name, []).append(entry)
    return xr.Dataset({name: (("entry",), np.asarray(values)) for name, values in columns.items()})
