"""Diagrams, located bifurcations and solvers as the claims of sections 3.3 and 4 need them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermogear.analysis.bifurcations import FLIP
from thermogear.analysis.continuation import cascade, continuation
from thermogear.analysis.diagram import orbit_diagram
from thermogear.analysis.labels import label as settle_label
from thermogear.analysis.labels import labels
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.proof import Label
from thermogear.analysis.settle import PERIODIC
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.parameters import long_name
from thermogear.base.vocabulary import label
from thermogear.case.case import DimensionlessCase
from thermogear.case.one_point import rows_of
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import TorsionalModel

SWEPT = {row: long_name(row) for row in ("zeta", "omega", "epsilon")}
"""Row of the table -> the parameter it sweeps."""
HEATS = ("none", "thesis", "consistent", "backlash")
"""Without heat; with the thesis's signs; with E(T); with the closing gap alone."""
HEATED = ("half_backlash", "thermal_stiffness")
OUTWARD = (0.0, 0.15, 0.4, 1.0)
"""How far beyond the row's start, in its own lengths, a period-1 orbit is looked for."""


@dataclass(frozen=True)
class Rows:
    """The base set, the ends of each row in the document's direction, and heat's two numbers.

    ``heat``: name -> (b', eps_T) at ``temperature`` [K].
    """

    base: dict[str, float]
    ends: dict[str, tuple[float, float]]
    heat: dict[str, tuple[float, float]]
    temperature: float

    def model(self, heat: str, **changes: float) -> TorsionalModel:
        """The base set under one kind of heat, with fields changed."""
        backlash, thermal = self.heat[heat]
        values = {**self.base, "half_backlash": backlash, "thermal_stiffness": thermal, **changes}
        return TorsionalModel(**values)


def rows(table: DimensionlessCase, section: DimensionlessCase) -> Rows:
    """What the two ready-made cases say; heat is that of the temperature row at 140 °C."""
    by_row = rows_of(table)
    ends: dict[str, tuple[float, float]] = {}
    base: dict[str, float] = {}
    for name, parameter in SWEPT.items():
        points = by_row[name]
        ends[name] = (points[0].value, points[-1].value)
        given = points[0].model_arguments()
        # each row holds the others' parameters at the base set
        base |= {key: value for key, value in given.items() if key not in (parameter, *HEATED)}
    warm = {name: points[-2] for name, points in rows_of(section).items()}
    temperature = warm["thesis"].value
    heat = {
        "none": (1.0, 0.0),
        "thesis": (warm["thesis"].half_backlash, warm["thesis"].thermal_stiffness),
        "consistent": (warm["consistent"].half_backlash, warm["consistent"].thermal_stiffness),
        "backlash": (warm["thesis"].half_backlash, 0.0),
    }
    return Rows(base, ends, heat, temperature)


def hottest(section: DimensionlessCase, row: str) -> TorsionalModel:
    """The model at the last temperature of a row of the ready-made temperature case."""
    return TorsionalModel(**rows_of(section)[row][-1].model_arguments())


def diagrams(base: Rows, values: int = 241) -> dict[str, Dataset]:
    """Orbit diagrams of every row without heat and with both kinds, by "row/heat"."""
    found = {}
    for name, parameter in SWEPT.items():
        low, high = sorted(base.ends[name])
        for heat in HEATS[:3]:
            data = orbit_diagram(
                base.model(heat), parameter, np.linspace(low, high, values), branch_period=0
            )
            found[f"{name}/{heat}"] = data.assign_attrs(row=name, heat=heat)
    return found


def flips(base: Rows, most: int = 4) -> Dataset:
    """Located period doublings of every row and kind of heat, along the document's direction.

    Over (row, heat, flip): ``value`` of the parameter (nan: none). A row that begins past its first
    flip is entered from outside. ``note`` says why no more flips came.
    """
    shape = (len(SWEPT), len(HEATS), most)
    value = np.full(shape, np.nan)
    note, lost = np.full(shape[:2], "", dtype=object), np.zeros(shape[:2], np.int8)
    for r, (name, parameter) in enumerate(SWEPT.items()):
        first, last = base.ends[name]
        for h, heat in enumerate(HEATS):
            start, begun = _enter(base, heat, parameter, first, last)
            if begun is None or begun.orbit is None:
                note[r, h] = "no period-1 orbit to start from"
                continue
            model = base.model(heat, **{parameter: start})
            orbit = periodic_orbit(model, 1, begun.orbit.state)
            found = cascade(orbit, parameter, last, flips=most)
            value[r, h, : len(found.flips)] = [flip.value for flip in found.flips]
            lost[r, h] = bool(found.lost)
            if len(found.flips) < most:
                note[r, h] = found.lost or found.branches[-1].ended
    dims = ("row", "heat", "flip")
    return label(
        {
            "value": (dims, value, "1", "parameter at the period doubling"),
            "note": (dims[:2], note.astype(str)),
            "lost": (dims[:2], lost, "1", "the branch behind the last flip was not found"),
        },
        {"row": list(SWEPT), "heat": list(HEATS), "flip": ("flip", np.arange(1, most + 1), "")},
        {"temperature": base.temperature},
    )


def _enter(
    base: Rows, heat: str, parameter: str, first: float, last: float
) -> tuple[float, Label | None]:
    for far in OUTWARD:
        start = first - far * (last - first)
        if start <= 0.0:
            continue
        label = settle_label(base.model(heat, **{parameter: start}))
        if label.name == "period-1":
            return start, label
    return first, None


def warming(section: DimensionlessCase) -> Dataset:
    """The temperature rows: label, largest multiplier, distinct section points, located flip.

    Over (row, temperature); ``flip`` [K] per row, nan where the whole range has none. Between the
    row's temperatures b' and eps_T run linearly.
    """
    by_row = rows_of(section)
    names = list(by_row)
    temperatures = np.array([p.value for p in by_row[names[0]]])
    shape = (len(names), temperatures.size)
    modulus, points = np.full(shape, np.nan), np.zeros(shape, np.int32)
    text = np.full(shape, "", dtype=object)
    flip = np.full(len(names), np.nan)
    start = section.simulation.initial_state
    for r, name in enumerate(names):
        row = by_row[name]
        columns = {
            key: np.array([p.model_arguments()[key] for p in row])
            for key in row[0].model_arguments()
        }
        found = labels(TorsionalModel(**columns), initial_state=start)
        for k, one in enumerate(found):
            text[r, k] = one.name
            if one.orbit is not None:
                modulus[r, k] = float(np.max(np.abs(one.orbit.multipliers)))
                points[r, k] = one.orbit.minimal_period
        flip[r] = _flip_over_temperature(temperatures, columns, found[0])
    dims = ("row", "temperature")
    return label(
        {
            "label": (dims, text.astype(str)),
            "multiplier": (dims, modulus, "", "largest Floquet multiplier, modulus"),
            "section_points": (dims, points, "", "distinct points of the section"),
            "flip": (("row",), flip, "K", "temperature of the flip"),
        },
        {"row": names, "temperature": ("temperature", temperatures, "K")},
    )


def _flip_over_temperature(temperatures: Floats, columns: dict[str, Floats], first: Label) -> float:
    if first.orbit is None or first.period != 1:
        return float("nan")

    def family(value: float) -> TorsionalModel:
        return TorsionalModel(
            **{key: float(np.interp(value, temperatures, row)) for key, row in columns.items()}
        )

    start, end = float(temperatures[0]), float(temperatures[-1])
    orbit = periodic_orbit(family(start), 1, first.orbit.state)
    branch = continuation(orbit, "temperature", end, family=family, start=start, stop_at=FLIP)
    found = branch.of_kind(FLIP)
    return found[0].value if found else float("nan")


def solver_orders(base: Rows, steps: tuple[int, ...] = (64, 128, 256, 512)) -> dict[str, Floats]:
    """Errors of fixed-step RK4 after some periods against the exact maps, smooth and rattling.

    ``smooth``: one that never leaves drive contact; ``rattling``: the base set. Largest error of
    (x, x') over 8 periods, for each number of steps in a period.
    """
    smooth = TorsionalModel(
        damping_ratio=base.base["damping_ratio"],
        frequency=base.base["frequency"],
        stiffness_amplitude=0.5 * base.base["stiffness_amplitude"],
        mean_force=2.0,
        force_amplitude=0.1,
    )
    found = {"steps": np.array(steps, dtype=float)}
    for name, model, start in (
        ("smooth", smooth, (3.0, 0.0)),
        ("rattling", base.model("none"), (1.0, 0.0)),
    ):
        true = _sections(model, start, "exact", 64)
        found[name] = np.array(
            [np.max(np.abs(_sections(model, start, "rk4", count) - true)) for count in steps]
        )
    return found


def _sections(model: TorsionalModel, start: tuple[float, float], method: str, steps: int) -> Floats:
    data = simulate(
        model, periods=8, discard=0, samples_per_period=0, initial_state=start,
        method=method, steps_per_period=steps,
    )  # fmt: skip
    return np.stack([data["section_x"].values[0], data["section_v"].values[0]])


def swing(model: TorsionalModel, start: tuple[float, float] = (0.0, 0.0)) -> tuple[float, float]:
    """(standard deviation, peak to peak) of the settled displacement."""
    data = simulate(model, periods=256, discard=2000, samples_per_period=64, initial_state=start)
    x = data["x"].values[0]
    return float(x.std()), float(np.ptp(x))


def sequence(data: Dataset, falling: bool) -> list[str]:
    """Labels met along a diagram, in the order of first meeting: "period-n", "chaotic", ..."""
    parameter = str(data.attrs["parameter"])
    direction = -1 if falling else 1
    here = data.sel(direction=direction).isel(start=0)
    order = np.argsort(here[parameter].values)
    order = order[::-1] if falling else order
    meanings = str(data["label"].attrs["flag_meanings"]).split()
    names = []
    for place in order:
        word = meanings[int(here["label"].values[place])]
        period = int(here["period"].values[place])
        names.append(f"period-{period}" if word == "periodic" else word)
    return list(dict.fromkeys(names))


def stability_falls(data: Dataset) -> bool:
    """Whether a period-1 motion comes nearer to its loss with every step of a falling parameter.

    The modulus [1] of its largest Floquet multiplier rises from the largest value of the diagram
    down to where period 1 ends, and it ends before the smallest value.
    """
    here = data.sel(direction=-1).isel(start=0)
    lost = np.flatnonzero(here["period"].values != 1)
    modulus = np.hypot(here["multiplier_real"].values, here["multiplier_imag"].values)
    return lost.size > 0 and bool(np.all(np.diff(modulus[lost[-1] + 1 :]) < 0.0))


def coexisting(data: Dataset) -> int:
    """Values of a diagram at which the way up and the way down end on different orbits."""
    up, down = (data.sel(direction=d).isel(start=0) for d in (1, -1))
    periodic = (up["label"].values == PERIODIC) & (down["label"].values == PERIODIC)
    other = up["period"].values != down["period"].values
    edges = [
        np.abs(
            extreme(up["section_x"].values, axis=-1) - extreme(down["section_x"].values, axis=-1)
        )
        for extreme in (np.nanmin, np.nanmax)
    ]
    return int(np.sum(periodic & (other | (np.maximum(*edges) > 1e-3))))


def scatter(data: Dataset) -> int:
    """Section points beyond the period, the most of all periodic points of a diagram."""
    worst = 0
    periodic = data["label"].values == PERIODIC
    for row, period in zip(
        data["section_x"].values[periodic], data["period"].values[periodic], strict=True
    ):
        found = np.unique(np.round(row[np.isfinite(row)], 6)).size
        worst = max(worst, found - int(period))
    return worst
