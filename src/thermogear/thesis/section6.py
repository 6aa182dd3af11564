"""Claims of section 6: the conclusions, each resting on rows before it."""

from __future__ import annotations

import numpy as np

from thermogear.base.display import PERCENT
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.thesis import section2, section2_growth, section3, section4, section5
from thermogear.thesis.claim import Claim, Finding, Verdict, listed, verdict_of
from thermogear.thesis.evidence import Evidence

EARLIER: tuple[Claim, ...] = (
    *section2.CLAIMS, *section2_growth.CLAIMS, *section3.CLAIMS, *section4.CLAIMS, *section5.CLAIMS
)  # fmt: skip
"""Every claim of sections 2 to 5, in the document's order."""
SENSITIVITY = "thermogear.study.sensitivity.sensitivity"
GRID = "thermogear.thesis.chain.operating_grid"


def judged(e: Evidence, number: str) -> Finding:
    """The finding of an earlier row."""
    return next(claim for claim in EARLIER if claim.number == number).judge(e)


def _holds(e: Evidence, output: str) -> str:
    here = e.sensitivity.data.sel(output=output)
    return f"{here['conclusion'].item()} in {PERCENT(float(here['holds'])):.0f} % of the samples"


def _rise(e: Evidence) -> Finding:
    numbers = [f"2.3.{k}" for k in range(10, 16)]
    found = [judged(e, number) for number in numbers]
    bad = [n for n, f in zip(numbers, found, strict=True) if f.verdict is Verdict.CONTRADICTED]
    good = sum(f.verdict is Verdict.REPRODUCED for f in found)
    return Finding(
        f"{good} of {len(found)} hold outright, {len(found) - good - len(bad)} with computed "
        f"temperatures, {len(bad)} not",
        f"contradicted: {', '.join(bad) or 'none'}",
        verdict_of(not bad, assumption=True),
        "Mixed friction falls with speed where temperatures are held; see the rows named.",
    )


def _lower(e: Evidence) -> Finding:
    given = e.grid.sel(thermal="given")
    friction = given["friction_mixed"].values / given["friction_dry"].values
    flash = given["flash_mixed"].values / given["flash_dry"].values
    return Finding(
        f"mixed over dry: friction {friction.min():.2f} to {friction.max():.2f}, flash "
        f"{flash.min():.2f} to {flash.max():.2f}",
        _holds(e, "dry_over_mixed"),
        verdict_of(float(max(friction.max(), flash.max())) < 1.0, assumption=True),
        "With a dry coefficient of 0.2 inside the stated range and mineral oil.",
    )


def _captures(e: Evidence) -> Finding:
    share = e.groups["motion"]["back_impacts"].values
    hits = float(np.nanmax(share))
    thesis, right = (
        e.groups["mesh"]["thermal_stiffness_ratio"].sel(bundle=b, state="hot").values[0]
        for b in ("thesis", "consistent")
    )
    return Finding(
        f"ε_T = {thesis:+.4f} in the dimensionless equation",
        f"ε_T = {right:+.4f}; back-side hits of the rig's motion: {hits:g}",
        verdict_of(thesis * right > 0.0),
        "Stiffness enters with the wrong sign, and the reduced backlash has no effect on a motion "
        "that never touches the back side.",
    )


def _mainly(e: Evidence) -> Finding:
    structure, stability = judged(e, "4.3.2"), judged(e, "4.3.10")
    return Finding(
        structure.thesis,
        structure.consistent,
        structure.verdict,
        f"That it acts on stability at all is row 4.3.10 ({stability.verdict}); that it does so "
        f"mainly asks for a structure that stays. {structure.argument}",
    )


def _control(e: Evidence) -> Finding:
    located = np.isfinite(e.flips["value"].sel(heat="none").values)
    counts = zip(section4.SYMBOLS.values(), located.sum(axis=-1), strict=True)
    return Finding(
        "; ".join(f"{symbol}: {count} flips" for symbol, count in counts),
        "located on continued branches",
        verdict_of(bool(located.all()), assumption=True),
        section4.SET,
    )


def _simulation_or_test(e: Evidence) -> Finding:
    ratio = e.bundle("mesh", "consistent", UNDEFORMED)["frequency_ratio"].values
    low, high = sorted(e.row_points.ends["omega"])
    found = judged(e, "5.2.9")
    return Finding(
        found.thesis,
        f"{found.consistent}; tests at ω_h = {listed(ratio, '.2f')}, diagrams at {low:g} to "
        f"{high:g}",
        found.verdict,
        "The tests cannot tell the two models apart, and they ran far from the regime in which the "
        "simulation's conclusions were drawn.",
    )


_ROWS = (
    ("6.1.1", "6, conclusion 1", "statement",
     "Friction, flash and deformation are strongly correlated.", lambda e: judged(e, "2.3.16"),
     ("thermogear.thesis.chain.correlations",), "grid-growth"),
    ("6.1.2", "6, conclusion 1", "statement", "They rise with speed and torque.", _rise, (GRID,),
     "grid-friction"),
    ("6.1.3", "6, conclusion 1", "statement", "Mixed lubrication gives less than dry friction.",
     _lower, (GRID, SENSITIVITY), "grid-flash"),
    ("6.2.1", "6, conclusion 2", "statement", "Heat reduces the backlash.",
     lambda e: judged(e, "3.1.1"), ("thermogear.mesh.clearance.Clearance",), "gap-temperature"),
    ("6.2.2", "6, conclusion 2", "statement", "Heat raises the mesh stiffness slightly.",
     lambda e: judged(e, "3.2.7"), ("thermogear.mesh.cycle.mesh_cycle",), "stiffness-0"),
    ("6.2.3", "6, conclusion 2", "statement", "The dimensionless model captures both effects.",
     _captures, ("thermogear.study.run.run",), ""),
    ("6.3.1", "6, conclusion 3", "statement",
     "Heat acts mainly on the stability of periodic motion.", _mainly,
     ("thermogear.thesis.motions.flips",), "diagram-omega"),
    ("6.3.2", "6, conclusion 3", "statement",
     "Damping, frequency and stiffness amplitude control period and bifurcations.", _control,
     ("thermogear.analysis.continuation.cascade",), "diagram-zeta"),
    ("6.4.1", "6, conclusion 4", "statement",
     "The tests confirm that the model with heat predicts better.", _simulation_or_test,
     ("thermogear.study.compare.compare",), "experiment"),
)  # fmt: skip

CLAIMS = tuple(Claim(*row) for row in _ROWS)
