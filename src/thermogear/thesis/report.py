"""Every claim judged, and the results that the judgements rest on, as one stored tree."""

from __future__ import annotations

import csv
import io
import time
from collections import Counter
from dataclasses import dataclass
from importlib.resources import files

from thermogear.base.arrays import Dataset
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.measured.comparison import result_of
from thermogear.results.result import Result, now
from thermogear.study.sensitivity import plain_words
from thermogear.thesis import section6
from thermogear.thesis.claim import Finding, Verdict
from thermogear.thesis.evidence import STAGES, Evidence, Size

TABLE = "sentences.csv"


@dataclass(frozen=True)
class Sentence:
    """A sentence by its ``digest``: where it stands and the numbers of the claims it makes.

    Without claims ``reason`` says why it makes none.
    """

    digest: str
    place: str
    claims: tuple[str, ...]
    reason: str = ""


def table() -> tuple[Sentence, ...]:
    """Every sentence of the document, in its order."""
    text = (files("thermogear.thesis") / TABLE).read_text(encoding="utf-8")
    rows = csv.DictReader(io.StringIO(text))
    return tuple(
        Sentence(row["sha256"], row["place"], tuple(row["claims"].split()), row["reason"])
        for row in rows
    )


CLAIMS = section6.EARLIER + section6.CLAIMS
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
        if not (found and evidence.finished("result")):
            raise
        return found
    evidence.progress(STAGES[-1], len(STAGES), len(STAGES))
    return found


def counts(findings: list[Finding]) -> dict[str, int]:
    """Verdict -> how many claims carry it, in the order of :class:`Verdict`."""
    number = Counter(finding.verdict for finding in findings)
    return {verdict.value: number[verdict] for verdict in Verdict}


def build(size: Size | None = None, progress: Progress = silent) -> Result:
    """All evidence and every verdict as one result; see :mod:`thermogear.thesis`.

    After Ctrl+C what was finished: fewer claims than ``claims_in_all``.
    """
    began = time.perf_counter()
    evidence = Evidence(Size() if size is None else size, progress)
    findings = judge(evidence)
    groups = dict(evidence.groups)
    groups["claims"] = _claims(findings)
    for name in filter(evidence.finished, ("grid", "flips", "warming")):
        groups[name] = getattr(evidence, name)
    if evidence.finished("comparison"):
        beside = result_of(evidence.comparison).groups
        groups |= {"experiment": beside["comparison"], "implied": beside["implied"]}
    if evidence.finished("rig_trains"):
        groups["rig_trains"] = evidence.rig_trains
    if evidence.finished("sensitivity"):
        groups["sensitivity"] = evidence.sensitivity.data.assign(
            sentence=(("output",), plain_words(evidence.sensitivity.data))
        )
    if evidence.finished("diagrams"):
        for name, data in evidence.diagrams.items():
            groups[f"diagrams/{name}"] = _plain(data)
    rig = evidence.result
    return Result(
        "thesis",
        TITLE,
        groups,
        rig.notices,
        {
            **rig.with_(
                created=now(),
                counts=counts(findings),
                claims_in_all=len(CLAIMS),
                sentences=_sentences(),
                seconds=time.perf_counter() - began,
                interrupted=len(findings) < len(CLAIMS),
            ).provenance
        },
    )


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


def _claims(findings: list[Finding]) -> Dataset:
    rows = [
        (
            claim.number, claim.place, claim.kind, claim.words, finding.thesis, finding.consistent,
            finding.verdict.value, finding.argument, " ".join(claim.code), claim.picture,
        )
        for claim, finding in zip(CLAIMS, findings, strict=False)
    ]  # fmt: skip
    columns = zip(TEXTS, zip(*rows, strict=True), strict=True)
    return label({name: (("claim",), list(column)) for name, column in columns})


def _sentences() -> dict[str, int]:
    rows = table()
    return {"all": len(rows), "claimed": sum(bool(row.claims) for row in rows)}


def _plain(data: Dataset) -> Dataset:
    """A diagram without what its picture does not need."""
    kept = data[["label", "period", "lyapunov", "section_x"]]
    return kept.assign_attrs({k: v for k, v in data.attrs.items() if isinstance(v, str | int)})
