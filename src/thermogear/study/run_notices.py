"""What a run found, in words and single figures: notices, facts, summary."""

from __future__ import annotations

import importlib.metadata
import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import thermogear
from thermogear.base.display import CELSIUS
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS, told_operating
from thermogear.case.case import GearCase
from thermogear.case.derived import Fact
from thermogear.case.derived import facts as case_facts
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.gears.deviations import PitchError
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.mesh.model import CHOICES
from thermogear.results.beside import from_data
from thermogear.results.result import Notice
from thermogear.results.tables import rows_along
from thermogear.study.measured_flanks import measured_notices
from thermogear.study.notices import friction_notices, reasons, several_words

if TYPE_CHECKING:
    import xarray as xr


STUDIED_FREQUENCIES = (1.1, 1.3)
"""Frequency ratios of the thesis's bifurcation study."""

MOST_POINTS = 12
"""The heat balance is told point by point up to so many; the stored group has them all."""

LIBRARIES = ("numpy", "scipy", "numba", "xarray", "h5netcdf", "matplotlib")


def _point(here: xr.Dataset | Mapping[str, Any], form: str = ".0f") -> str:
    """Speed and torque of one operating point."""
    speed, torque = float(here["pinion_speed"]) / RPM, float(here["pinion_torque"])
    return f"{speed:{form}} rpm, {torque:{form}} N m"


# --- notices ------------------------------------------------------------------------------


def notices(case: GearCase, groups: Mapping[str, xr.Dataset]) -> Iterator[Notice]:
    """What a reader should know before the pictures, most important first."""
    mesh = groups["mesh"]
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
    yield from _edges(mesh)
    if any(model.thermal_stiffness == "thesis" for model in case.models):
        yield Notice(
            "info",
            "The thesis's thermal stiffness k_T has no cold limit (it tends to infinity as "
            "the growth vanishes); it is set to 0 where nothing has grown.",
        )
    yield Notice(
        "info",
        "Undeformed and hot differ in the growth of gears and housing alone; oil and "
        "film are equally warm in both: friction and flash can be compared.",
    )
    yield from friction_notices(case, groups)
    if case.base_sets and not of_the_thesis(case):
        yield Notice(
            "info",
            "draw.base_sets: left out. These sets belong to the ready-made case, and this "
            "case has other values.",
        )
    if mesh.sizes["bundle"] > 1:
        yield _difference(mesh)


def _stiffness(case: GearCase, mesh: xr.Dataset) -> Iterator[Notice]:
    """How the models of the mesh stiffness stand to each other, in this case."""
    for place, model in enumerate(case.models):
        if not model.stiffness.startswith("textbook"):
            continue
        cold = mesh.isel(bundle=place, state=0, operating=0)
        over = [
            float(cold["mean_stiffness"]) / float(cold[f"{body}_stiffness"]) - 1.0
            for body in ("rim", "bore_clamped")
        ]
        yield Notice(
            "warning",
            f"{model.name}: the mesh stiffness is the textbook sum of tooth pairs that do not "
            f"feel each other. For this pair its mean without heat lies {_above(over[0])} "
            f"that of the loaded contact, {_above(over[1])} it with the bodies clamped at "
            "their bores.",
        )
    if any(model.stiffness == "loaded" for model in case.models):
        yield Notice(
            "info",
            "The loaded contact takes plane-stress bodies. Contact on tip corners and relief "
            "stand without a finite-element check; `thermogear verify stiffness` holds the "
            "rest of this pair's contact against finite elements. For the vibration the "
            "body's wind-up against its bore is left to the inertia (the reading named "
            "rim); both readings are among the figures.",
        )


def _edges(mesh: xr.Dataset) -> Iterator[Notice]:
    """Where a tip corner carries, and what that leaves unknown."""
    shares = 100.0 * mesh["edge_contact_share"].values
    if not np.any(shares > 0.0):
        return
    least, most = f"{np.nanmin(shares):.1f}", f"{np.nanmax(shares):.1f}"
    span = most if least == most else f"{least} to {most}"
    yield Notice(
        "info",
        f"Edge contact: under load the corner of a tip carries for {span} % "
        "of the mesh period in the loaded contact. Hertz's pressure is not valid there and is "
        "left out; stiffness, shares, friction and flash take the corner for a flank.",
    )


def _above(part: float) -> str:
    """A relative difference as so many per cent above or below."""
    return f"{100.0 * abs(part):.0f} % {'above' if part > 0.0 else 'below'}"


def _computed(case: GearCase, groups: Mapping[str, xr.Dataset]) -> Iterator[Notice]:
    """What the heat balance found, where it decides the temperatures."""
    if "balance" not in groups:
        return
    balance = groups["balance"]
    ours = sum(one.field.startswith("gearbox.") for one in case.assumptions)
    limit = min(g.material.tempering_temperature for g in (case.pair.pinion, case.pair.wheel))
    lost_by = json.loads(balance.attrs.get("lost", "{}"))
    for place, bundle in enumerate(balance["bundle"].values):
        here = balance.isel(bundle=place)
        settled = here["status"].values == STATUS.index("ok")
        lost = int(np.sum(~settled))
        if lost:
            yield Notice(
                "important",
                f"{bundle}: {lost} of {settled.size} operating points have no steady "
                "temperature; their status is heat_not_settled and they have no motion."
                + reasons(lost_by.get(str(bundle), {}).values()),
            )
        if not settled.any():
            continue
        if text := several_words(here, settled):
            yield Notice("important", f"{bundle}: {text}")
        steady = here.isel(operating=np.flatnonzero(settled))
        teeth = steady["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"])
        oil = steady["node_temperature"].sel(node="oil")
        text = (
            f"{bundle}: temperatures computed from the heat balance; teeth "
            f"{CELSIUS.text(float(teeth.min()), 1)} to {CELSIUS.text(float(teeth.max()), 1)}, oil "
            f"{CELSIUS.text(float(oil.min()), 1)} to {CELSIUS.text(float(oil.max()), 1)}, settled "
            f"within {int(steady['iterations'].max())} iterations to "
            f"{float(steady['residual'].max()):.1g} K. They rest on the gearbox's values; "
            f"{ours or 'none'} of them "
            f"{'is' if ours == 1 else 'are'} ours."
        )
        hot = float(teeth.max()) > limit
        if hot:
            text += f" The teeth pass {CELSIUS.text(limit, 1)}, where their material is tempered."
        yield Notice("important" if hot else "info", text)


def _deviations(case: GearCase) -> Iterator[Notice]:
    """What a reader must know where flanks deviate from the involute."""
    if not case.deviations:
        return
    deaf = [m.name for m in case.models if m.stiffness != "loaded"]
    count = len(case.deviations)
    text = (
        f"{count} deviation{'s' if count > 1 else ''} of the flanks: in clearance, jam and error, "
        "and in stiffness and load shares of the loaded contact."
    )
    if case.transmission_error.harmonics:
        text += (
            " The kinematic error of [transmission_error] comes on top: what the deviations cause "
            "should not stand there again."
        )
    if deaf:
        text += f" The textbook sum of {', '.join(deaf)} does not feel them."
    yield Notice("warning" if deaf else "info", text)
    if any(isinstance(d, PitchError) and np.ptp(d.errors) > 0.0 for d in case.deviations):
        yield Notice(
            "warning",
            "Pitch errors: a run holds the teeth of one mesh period. Other teeth may leave "
            "less clearance and jam earlier; `loaded_contact` takes phases of whole "
            "revolutions.",
        )


def _jammed(case: GearCase, mesh: xr.Dataset) -> Iterator[Notice]:
    hot = mesh.isel(state=-1)
    yield from (Notice("important", words) for words in from_data(hot))
    for place, bundle in enumerate(mesh["bundle"].values):
        here = hot.isel(bundle=place)
        bare = mesh.isel(state=0, bundle=place)["status"] == STATUS.index("jammed")
        if bool(bare.any()):
            yield Notice(
                "important",
                f"{bundle}: {int(bare.sum())} of {here.sizes['operating']} operating points "
                "are jammed without heat: the deviations of the flanks take more than the "
                "cold backlash. Jammed points have no motion.",
            )
            continue
        jammed = int((here["status"] == STATUS.index("jammed")).sum())
        alone, words = _jams(here, case.stated.temperatures.reference)
        if jammed:
            yield Notice(
                "important",
                f"{bundle}: {jammed} of {here.sizes['operating']} operating points are jammed "
                f"when hot. The backlash is used up {words}. Jammed points have no motion.",
            )
        elif math.isfinite(alone) and alone < ZERO_CELSIUS + 400.0:
            yield Notice("info", f"{bundle}: the pair would jam {words}.")


def _jams(here: xr.Dataset, reference: float) -> tuple[float, str]:
    """Least jam temperature [K] of gears that rise alone, and both jams in words.

    In proportion it is the one nearest to the ``reference`` [K], from where all bodies go.
    """
    alone, together = (
        np.ravel(here[name].values) for name in ("jam_temperature", "proportional_jam_temperature")
    )
    least = float(np.nanmin(alone, initial=np.inf))
    first = f"at {_degrees(alone, np.argsort(alone), here)} of the pinion's addendum"
    words = f"{first} where both gears rise alike with the housing as it is"
    nearest = np.argsort(np.abs(together - reference))
    known = float(together[nearest[0]])
    if not math.isfinite(known):
        return least, f"{words}, and never where shafts and housing go along in proportion"
    way = "rise" if known > reference else "cool"
    at = _degrees(together, nearest, here)
    return least, f"{words}, at {at} where shafts and housing {way} in proportion to the gears"


def _degrees(kelvin: NDArray[np.float64], order: NDArray[np.int64], here: xr.Dataset) -> str:
    """The first of some temperatures in ``order``, with its operating point where they differ."""
    first = int(order[0])
    if not math.isfinite(kelvin[first]):
        return "no temperature"
    text = f"{kelvin[first] - ZERO_CELSIUS:.0f} °C"
    if np.all(np.abs(kelvin - kelvin[first]) < 0.5):
        return text
    return f"{text} ({_point(here.isel(operating=first), '.5g')})"


def _regime(case: GearCase, mesh: xr.Dataset) -> Iterator[Notice]:
    ratios = mesh["frequency_ratio"].isel(bundle=0, state=0).values
    low, high = STUDIED_FREQUENCIES
    f_n = float(mesh["natural_frequency"].isel(bundle=0, state=0, operating=0))
    per_rpm = case.pair.pinion.teeth / 60.0
    studied = [f_n * ratio / per_rpm for ratio in (low, high)]
    inside = (ratios >= low) & (ratios <= high)
    if np.any(inside):
        return
    yield Notice(
        "important",
        f"Two regimes: the speeds of this case lie at frequency ratios "
        f"{ratios.min():.2f} to {ratios.max():.2f} of the natural frequency "
        f"of the undeformed mean stiffness ({f_n:.0f} Hz), while the thesis's bifurcation "
        f"study at {low} to {high} would mean {studied[0]:.0f} to {studied[1]:.0f} rpm. "
        "Nothing found in one speaks for the other.",
    )


def _motion(motion: xr.Dataset) -> Iterator[Notice]:
    names = Counter(str(name) for name in motion["label"].values.ravel())
    if names["undecided"]:
        yield Notice(
            "warning",
            f"{names['undecided']} motions are undecided: they neither close nor are they "
            "chaotic to the end; the reason stands with each.",
        )
    if "back_impacts" in motion:
        impacts = motion["back_impacts"].values
        moving = np.isfinite(impacts)
        if moving.any() and not np.any(impacts[moving] > 0.0):
            yield Notice(
                "info",
                "b' has no effect here: no tooth ever hits the back side, so the backlash "
                "can be moved out of the equation; heat acts through stiffness and error "
                "alone.",
            )
        elif moving.any():
            free = int(np.sum(impacts[moving] == 0.0))
            yield Notice(
                "info",
                f"b' has no effect on {free} of {int(moving.sum())} motions, whose teeth "
                "never hit the back side.",
            )


def _row_jams(row: xr.Dataset) -> Iterator[Notice]:
    jammed = row["status"] == STATUS.index("jammed")
    for place, bundle in enumerate(row["bundle"].values):
        here = jammed.isel(bundle=place).any("operating")
        temperatures = row["gear_temperature"].values[here.values]
        if temperatures.size:
            text = ", ".join(f"{t - ZERO_CELSIUS:.0f}" for t in temperatures)
            yield Notice("important", f"{bundle}: jammed at gear temperatures of {text} °C.")


def _difference(mesh: xr.Dataset) -> Notice:
    parts = []
    for place, bundle in enumerate(mesh["bundle"].values):
        here = mesh.isel(bundle=place, operating=told_operating(mesh))
        cold, hot = (float(here["mean_stiffness"].isel(state=i)) for i in (0, -1))
        b = float(here["half_backlash"].isel(state=-1)) * 1e6
        if math.isnan(b):
            continue
        parts.append(f"{bundle}: stiffness {100 * (hot / cold - 1):+.1f} %, b' = {b:.1f} um")
    told = "; ".join(parts) or "no point has a hot state"
    return Notice("important", f"What heat does depends on the bundle. {told}.")


def dimensionless_notices(points: xr.Dataset) -> Iterator[Notice]:
    """The notices of a dimensionless case."""
    yield Notice(
        "info",
        "These are parameter sets of the dimensionless equation; they are not derived from "
        "any gear pair.",
    )
    yield from _motion(points)


# --- facts --------------------------------------------------------------------------------


def facts(case: GearCase, groups: Mapping[str, xr.Dataset]) -> list[dict[str, object]]:
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


def _frequencies(case: GearCase, cold: xr.Dataset) -> Iterator[Fact]:
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


def _balance_facts(balance: xr.Dataset | None) -> Iterator[Fact]:
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


def _balance_of(here: xr.Dataset) -> Iterator[Fact]:
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


def choice_meanings() -> dict[str, dict[str, str]]:
    """What every choice of the mesh model means, for the page's table."""
    return {field: dict(names) for field, names in CHOICES.items()}


def environment(python: str) -> dict[str, str]:
    """Versions that a result depends on."""
    found = {"thermogear": thermogear.__version__, "python": python}
    for name in LIBRARIES:
        found[name] = importlib.metadata.version(name)
    return found
