"""What a run found, in words and single figures: notices, facts, summary."""

from __future__ import annotations

import importlib.metadata
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

import thermogear
from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS, told_operating
from thermogear.case.case import GearCase
from thermogear.case.derived import Fact
from thermogear.case.derived import facts as case_facts
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.results.beside import from_data
from thermogear.results.result import Notice
from thermogear.results.tables import rows_along
from thermogear.study.declared import fault_notices
from thermogear.study.measured_flanks import measured_notices
from thermogear.study.notices import friction_notices, heat_notices, jam_notices, turn_notices

STUDIED_FREQUENCIES = (1.1, 1.3)
"""Frequency ratios of the thesis's bifurcation study."""

HOTTEST_JAM = ZERO_CELSIUS + 400.0
"""Jam temperature [K] below which that of a pair with backlash left is of interest: ours, hotter
than any gear runs."""

MOST_POINTS = 12
"""The heat balance is told point by point up to so many; the stored group has them all."""

LIBRARIES = ("numpy", "scipy", "numba", "xarray", "h5netcdf", "matplotlib")


def _point(here: Dataset | Mapping[str, Any], form: str = ".0f") -> str:
    """Speed and torque of one operating point."""
    speed, torque = float(here["pinion_speed"]) / RPM, float(here["pinion_torque"])
    return f"{speed:{form}} rpm, {torque:{form}} N m"


# --- notices ------------------------------------------------------------------------------


def notices(case: GearCase, groups: Mapping[str, Dataset]) -> Iterator[Notice]:
    """What a reader should know before the pictures, most important first."""
    mesh = groups["mesh"]
    yield from fault_notices(case)
    yield from _computed(case, groups)
    yield from _jammed(case, mesh)
    yield from _deviations(case)
    yield from measured_notices(case)
    if of_the_thesis(case):
        yield from _regime(case, mesh)
    if "motion" in groups:
        yield from _motion(groups["motion"])
    if "temperature" in groups:
        yield from _row_jams(groups["temperature"])
    yield from _stiffness(case, mesh)
    shares = mesh["edge_contact_share"].values
    if np.any(shares > 0.0):
        yield Notice.of("edge_contact", shares=[[np.nanmin(shares), np.nanmax(shares)]])
    if any(model.thermal_stiffness == "thesis" for model in case.models):
        yield Notice.of("thermal_stiffness_without_cold_limit")
    yield Notice.of("heat_is_growth_alone")
    yield from friction_notices(case, groups)
    if case.base_sets and not of_the_thesis(case):
        yield Notice.of("base_sets_left_out")
    if mesh.sizes["bundle"] > 1:
        yield from _difference(mesh)


def _stiffness(case: GearCase, mesh: Dataset) -> Iterator[Notice]:
    """How the models of the mesh stiffness stand to each other, in this case."""
    for place, model in enumerate(case.models):
        if not model.stiffness.startswith("textbook"):
            continue
        cold = mesh.isel(bundle=place, state=0, operating=0)
        over = [
            float(cold["mean_stiffness"]) / float(cold[f"{body}_stiffness"]) - 1.0
            for body in ("rim", "bore_clamped")
        ]
        yield Notice.of(
            "stiffness_is_textbook_sum", about=model.name, over_rim=over[0], over_clamped=over[1]
        )
    if any(model.stiffness == "loaded" for model in case.models):
        yield Notice.of("loaded_contact_unchecked", body="rim")
        yield Notice.of("wind_up_left_to_inertia")


def _computed(case: GearCase, groups: Mapping[str, Dataset]) -> Iterator[Notice]:
    """What the heat balance found, where it decides the temperatures."""
    if "balance" not in groups:
        return
    balance = groups["balance"]
    ours = sum(one.field.startswith("gearbox.") for one in case.assumptions)
    limit = min(g.material.tempering_temperature for g in (case.pair.pinion, case.pair.wheel))
    lost_by = json.loads(balance.attrs.get("lost", "{}"))
    for place, name in enumerate(balance["bundle"].values):
        bundle = str(name)
        here = balance.isel(bundle=place)
        settled = here["status"].values == STATUS.index("ok")
        yield from heat_notices(here, settled, lost_by.get(bundle, {}).values(), bundle)
        if not settled.any():
            continue
        steady = here.isel(operating=np.flatnonzero(settled))
        teeth = steady["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"])
        oil = steady["node_temperature"].sel(node="oil")
        hottest = float(teeth.max())
        if hottest > limit:
            yield Notice.of("teeth_tempered", about=bundle, hottest=hottest, limit=limit)
        yield Notice.of(
            "temperatures_computed",
            about=bundle,
            teeth=[[teeth.min().item(), hottest]],
            oil=[[oil.min().item(), oil.max().item()]],
            iterations=steady["iterations"].max().item(),
            residual=steady["residual"].max().item(),
            assumed=ours,
        )


def _deviations(case: GearCase) -> Iterator[Notice]:
    """What a reader must know where flanks deviate from the involute."""
    if not case.deviations:
        return
    yield Notice.of("flanks_deviate", deviations=len(case.deviations))
    yield from turn_notices(case, alike="pictures over a dial's temperature")
    if case.series > 1 and case.file.flanks is not None:
        number = case.file.flanks.drawing if case.file.flanks.teeth == "drawn" else None
        yield Notice.of(
            "one_part_run", parts=case.series, seed=case.seed, accuracy=case.accuracy,
            drawing=number, alike="alike" if number is None else None,
        )  # fmt: skip
    if case.transmission_error.harmonics:
        yield Notice.of("kinematic_error_on_top")
    deaf = [m.name for m in case.models if m.stiffness != "loaded"]
    if deaf:
        yield Notice.of("deviations_not_felt", bundles=deaf)


def _jammed(case: GearCase, mesh: Dataset) -> Iterator[Notice]:
    hot = mesh.isel(state=-1)
    yield from from_data(hot)
    for place, name in enumerate(mesh["bundle"].values):
        bundle = str(name)
        here = hot.isel(bundle=place)
        bare = mesh.isel(state=0, bundle=place)["status"] == STATUS.index("jammed")
        count = here.sizes["operating"]
        if bool(bare.any()):
            yield Notice.of("jammed_cold", about=bundle, jammed=bare.sum().item(), points=count)
            continue
        jammed = int((here["status"] == STATUS.index("jammed")).sum())
        least = np.nanmin(here["jam_temperature"].values, initial=np.inf)
        if jammed:
            yield Notice.of("jammed_hot", about=bundle, jammed=jammed, points=count)
        if jammed or least < HOTTEST_JAM:
            yield from jam_notices(here, case.stated.temperatures.reference, bundle)


def _regime(case: GearCase, mesh: Dataset) -> Iterator[Notice]:
    ratios = mesh["frequency_ratio"].isel(bundle=0, state=0).values
    low, high = STUDIED_FREQUENCIES
    if np.any((ratios >= low) & (ratios <= high)):
        return
    f_n = float(mesh["natural_frequency"].isel(bundle=0, state=0, operating=0))
    per_ratio = 2.0 * math.pi * f_n / case.pair.pinion.teeth
    yield Notice.of(
        "two_regimes",
        ratios=[[ratios.min(), ratios.max()]],
        natural_frequency=f_n,
        studied=[[low, high]],
        speeds=[[low * per_ratio, high * per_ratio]],
    )


def _motion(motion: Dataset) -> Iterator[Notice]:
    undecided = int((motion["label"] == "undecided").sum())
    if undecided:
        yield Notice.of("motions_undecided", undecided=undecided)
    if "back_impacts" in motion:
        impacts = motion["back_impacts"].values
        moving = int(np.isfinite(impacts).sum())
        if moving:
            free = int(np.sum(impacts == 0.0))
            yield Notice.of("back_flanks_free", free=free, motions=moving)


def _row_jams(row: Dataset) -> Iterator[Notice]:
    jammed = (row["status"] == STATUS.index("jammed")).any("operating")
    for bundle, here in zip(
        row["bundle"].values, jammed.transpose("bundle", ...).values, strict=True
    ):
        if here.any():
            yield Notice.of(
                "row_jammed", about=str(bundle), temperatures=row["gear_temperature"].values[here]
            )


def _difference(mesh: Dataset) -> Iterator[Notice]:
    at = mesh.isel(operating=told_operating(mesh))
    known = at.isel(bundle=np.isfinite(at["half_backlash"].isel(state=-1).values))
    if known.sizes["bundle"]:
        stiffness = known["mean_stiffness"]
        yield Notice.of(
            "heat_by_bundle",
            bundles=known["bundle"].values,
            stiffness=(stiffness.isel(state=-1) / stiffness.isel(state=0) - 1.0).values,
            half_backlash=known["half_backlash"].isel(state=-1).values,
        )


def dimensionless_notices(points: Dataset) -> Iterator[Notice]:
    """The notices of a dimensionless case."""
    yield Notice.of("sets_of_no_gears")
    yield from _motion(points)


# --- facts --------------------------------------------------------------------------------


def facts(case: GearCase, groups: Mapping[str, Dataset]) -> list[dict[str, object]]:
    """The case's own figures, then those of the run: frequencies, plausibility."""
    mesh = groups["mesh"]
    cold, hot = (mesh.isel(state=end) for end in (0, -1))
    heat = hot.isel(bundle=0, operating=told_operating(mesh))
    table = [
        *case_facts(case),
        *_frequencies(case, cold.isel(operating=0)),
        *dict.fromkeys(_iso(case, row) for row in rows_along(cold.isel(bundle=0), "operating")),
    ]
    for name in ("pinion", "wheel"):
        watts = float(heat[f"{name}_shaft_heat"])
        table.append(Fact("heat the assumed field sends into the shaft", name, watts, "W"))
    for row in rows_along(hot.isel(bundle=0), "operating"):
        loss = row["frictional_power"]
        table.append(Fact("frictional power of the mesh", f"at {_point(row)}", loss, "W"))
    return [asdict(fact) for fact in (*table, *_balance_facts(groups.get("balance")))]


def _frequencies(case: GearCase, cold: Dataset) -> Iterator[Fact]:
    """Natural frequencies of the mean stiffness of every bundle, and of the loaded contact."""
    for row in rows_along(cold, "bundle"):
        natural = row["natural_frequency"]
        name = row["bundle"]
        resonance = 60.0 * natural / case.pair.pinion.teeth
        yield Fact("natural frequency of the undeformed mean stiffness", name, natural, "Hz")
        yield Fact("pinion speed of the mesh resonance", name, resonance, "rpm")
    for body, words in (("rim", "rim"), ("bore_clamped", "bore clamped")):
        k = float(cold[f"{body}_stiffness"].isel(bundle=0))
        natural = math.sqrt(k / case.equivalent_mass) / (2.0 * math.pi)
        yield Fact("loaded contact, undeformed, two readings of the bore", words, k, "N/m")
        yield Fact("natural frequency of the loaded contact", words, natural, "Hz")


def _iso(case: GearCase, row: Mapping[str, Any]) -> Fact:
    """The mesh stiffness of ISO 6336-1 at the load of an operating point."""
    tangential = row["normal_force"] * math.cos(case.pair.pinion.pressure_angle)
    width = case.pair.face_width
    value = float(iso6336_stiffness(case.pair, tangential / width).mesh) * width
    at = f"at {row['pinion_torque']:.0f} N m"
    return Fact("mesh stiffness by ISO 6336-1 method B (knows no bore)", at, value, "N/m")


def _balance_facts(balance: Dataset | None) -> Iterator[Fact]:
    """Node temperatures and losses of every operating point, and the corrected readings."""
    if balance is None:
        return
    for one in json.loads(str(balance.attrs["readings"])):
        words = (
            f"{one['node']}, {one['kind']} reading {CELSIUS.text(one['indicated_K'], 1)} corrected"
        )
        value = f"{CELSIUS.text(one['temperature_K'], 1)} +- {one['uncertainty_K']:.2g} K"
        yield Fact("measured temperatures", words, value)
    few = balance.isel(operating=slice(MOST_POINTS))
    if "half_backlash_uncertainty" in balance:
        words = "uncertainty of b' from the measured temperatures"
        for row in rows_along(few, "operating"):
            yield Fact(words, f"at {_point(row)}", 1e6 * row["half_backlash_uncertainty"], "um")
    for bundle, o in np.ndindex(few.sizes["bundle"], few.sizes["operating"]):
        yield from _balance_of(few.isel(bundle=bundle, operating=o))


def _balance_of(here: Dataset) -> Iterator[Fact]:
    """The heat balance of one bundle at one operating point."""
    group = f"heat balance, {here['bundle'].item()}, {_point(here)}"
    if np.isnan(here["residual"]):
        yield Fact(group, "temperatures", "no value")
        return
    for row in rows_along(here, "node"):
        yield Fact(group, f"{row['node']} temperature", CELSIUS.text(row["node_temperature"], 1))
    for row in rows_along(here, "loss_kind"):
        yield Fact(group, f"{row['loss_kind']} loss", row["loss"], "W")
    for row in rows_along(here, "bearing") if "bearing" in here.coords else ():
        thin = 1e6 * row["bearing_viscosity"]
        yield Fact(group, f"{row['bearing']} loss", row["bearing_loss"], "W")
        yield Fact(group, f"{row['bearing']} viscosity", thin, "mm^2/s")
    yield Fact(group, "iterations", int(here["iterations"]))
    yield Fact(group, "residual", float(here["residual"]), "K")


def environment(python: str) -> dict[str, str]:
    """Versions that a result depends on."""
    versions = {name: importlib.metadata.version(name) for name in LIBRARIES}
    return {"thermogear": thermogear.__version__, "python": python, **versions}
