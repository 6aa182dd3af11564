"""Lines of simulated cases: from stored motion, with numerical and input uncertainty, and the
motion as a record that goes through a measured record's own chain."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.case.allowed import gear_parameter
from thermogear.measured.published import LineTable, SpeedLine
from thermogear.measured.record import Channel, Record
from thermogear.results.result import Notice, Result

if TYPE_CHECKING:
    from thermogear.case.case import Case

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class CaseLines:
    """Tables by model, relative u_num, u_input by speed [rad/s], notices."""

    tables: Mapping[str, LineTable]
    u_num: float
    u_input: Mapping[float, float]
    notices: tuple[Notice, ...]


def tree_lines(result: Result) -> dict[str, LineTable]:
    """The mesh line of the simulated motion, one table per bundle and state ("thesis hot").

    Operating points without a motion (jammed, diverged) are left out; of several torques at one
    speed the first stands for it.
    """
    motion = result.group("motion")
    if motion is None:
        raise InputError("simulated", "no motion", fix='draw.pictures must hold "motion"')
    first = int(np.argmin(np.abs(motion["order"].values - 1.0)))
    speeds = np.asarray(motion["pinion_speed"].values, dtype=float)
    frequency = motion["line_frequency"].isel(order=first)
    found: dict[str, LineTable] = {}
    for bundle in motion["bundle"].values:
        for state in motion["state"].values:
            here = {"bundle": bundle, "state": state}
            amplitude = motion["line_amplitude"].isel(order=first).sel(here)
            lines: dict[float, SpeedLine] = {}
            for place, speed in enumerate(speeds):
                x = float(amplitude.values[place])
                f = float(np.asarray(frequency.values)[place])
                if np.isfinite(x) and x > 0 and float(speed) not in lines:
                    lines[float(speed)] = SpeedLine(speed=float(speed), frequency=f, displacement=x)
            if lines:
                name = f"{bundle} {state}"
                found[name] = LineTable(name, tuple(lines.values()), None, "simulation")
    if not found:
        raise InputError("simulated", "no line", why="no operating point has a motion")
    return found


def case_lines(
    case: Case | str | Path,
    tolerances: Mapping[str, float],
    *,
    samples: int,
    seed: int,
    u_num: float | None,
) -> CaseLines:
    """The case simulated, its step doubled for u_num, and sampled within its tolerances."""
    from thermogear.case.case import Case as CaseType
    from thermogear.case.case import load_case
    from thermogear.study.run import run

    if isinstance(case, CaseType):
        text, kept = case.text, dict(case.overrides)
    else:
        text, kept = load_case(case).text, {}
    kept["draw.pictures"] = '["motion"]'
    notices: list[Notice] = []

    def tables(changes: Mapping[str, str]) -> dict[str, LineTable]:
        return tree_lines(run(load_case(text, {**kept, **changes})))

    base = tables({})
    if u_num is None:
        steps = _steps(text, kept)
        coarse = tables({"simulation.steps_per_period": str(steps // 2)})
        # fourth order: the coarse run's error is 16/15 of the difference, the fine one's 1/15
        u_num = max(_differences(base, coarse).values(), default=0.0) / 15.0
        notices.append(
            Notice(
                "info", f"u_num {100 * u_num:.3g} % from {steps} and {steps // 2} steps a period"
            )
        )
    u_input: dict[float, float] = {}
    if tolerances:
        rng = np.random.default_rng(seed)
        spread: dict[float, list[float]] = {}
        for _ in range(max(2, samples)):
            changes: dict[str, str] = {}
            for name, sigma in tolerances.items():
                factor = float(1.0 + sigma * rng.standard_normal())
                changes |= overrides_of(text, kept, name, factor)
            for speed, value in _relative(base, tables(changes)).items():
                spread.setdefault(speed, []).append(value)
        u_input = {s: float(np.std(v, ddof=1)) for s, v in spread.items() if len(v) > 1}
    else:
        notices.append(Notice("warning", "no tolerances of the case are stated: u_input is 0"))
    return CaseLines(base, u_num, u_input, tuple(notices))


def _relative(base: Mapping[str, LineTable], other: Mapping[str, LineTable]) -> dict[float, float]:
    """Ratio of the displacements less 1 by speed, for the first model common to both."""
    name = next((n for n in base if n in other), None)
    if name is None:
        return {}
    found = {}
    for line in base[name].lines:
        twin = other[name].near(line.speed)
        if twin is not None:
            found[line.speed] = twin.displacement / line.displacement - 1.0
    return found


def _differences(
    base: Mapping[str, LineTable], other: Mapping[str, LineTable]
) -> dict[float, float]:
    return {speed: abs(value) for speed, value in _relative(base, other).items()}


def _steps(text: str, changes: Mapping[str, str]) -> int:
    try:
        return int(_stated(text, changes, "simulation.steps_per_period"))
    except InputError:
        from thermogear.case.case import load_case

        return load_case(text, changes).simulation.steps_per_period


def _stated(text: str, changes: Mapping[str, str], name: str) -> str:
    """A field as the case states it, as text."""
    if name in changes:
        return changes[name]
    value: Any = tomllib.loads(text)
    for part in name.split("."):
        if not isinstance(value, dict) or part not in value:
            raise InputError("tolerances", repr(name), why="the case states no such field")
        value = value[part]
    if not isinstance(value, (str, int, float)) or isinstance(value, bool):
        raise InputError("tolerances", repr(name), why="it is no single number with a unit")
    return str(value)


def scaled(value: str, factor: float) -> str:
    """A number with its unit times a factor: "100 N m" by 1.1 is "110 N m"."""
    found = re.match(r"^\s*([-+]?\d*\.?\d+(?:[eE][-+]?\d+)?)\s*(.*)$", value)
    if not found:
        raise InputError("tolerances", repr(value), why="it is no number with a unit")
    number = float(found.group(1)) * factor
    return f"{number!r} {found.group(2)}".strip()


def overrides_of(text: str, changes: Mapping[str, str], name: str, factor: float) -> dict[str, str]:
    """The overrides that multiply a parameter by a factor, in every field it stands for.

    ``name``: a gear parameter by any of its names, or a dotted field;
    "transmission_error.amplitude" means the amplitudes of all its harmonics.
    """
    if name != "transmission_error.amplitude":
        fields = gear_parameter(name, "tolerances").fields
        return {one: scaled(_stated(text, changes, one), factor) for one in fields}
    field = "transmission_error.harmonics"
    if field in changes:
        table: Any = tomllib.loads(f"harmonics = {changes[field]}")
    else:
        table = tomllib.loads(text).get("transmission_error", {})
    rows = table.get("harmonics", [])
    if not rows:
        raise InputError("parameters", repr(name), why="the case states no transmission error")
    parts = []
    for row in rows:
        grown = {**row, "amplitude": scaled(str(row["amplitude"]), factor)}
        pairs = (f"{k} = {v if not isinstance(v, str) else repr(v)}" for k, v in grown.items())
        parts.append("{ " + ", ".join(pairs) + " }")
    return {field: "[" + ", ".join(parts) + "]"}


def simulated_record(
    displacement: Floats, periods: int, *, mesh_frequency: float, rate: float, samples: int
) -> Record:
    """A periodic motion as the acceleration record that a sensor would give of it [m/s^2].

    ``displacement`` [m]: uniform samples over ``periods`` whole mesh periods, the first at phase
    0; ``mesh_frequency`` [Hz]; ``rate`` [1/s] and ``samples`` those of the record it is to be
    compared with: then ``measure`` with that record's chain reads like from like. Lines above
    half the rate do not reach the record, as behind an anti-alias filter.
    """
    x = np.asarray(displacement, dtype=float)
    if x.ndim != 1 or x.size < 4 or periods < 1:
        raise InputError("displacement", f"shape {x.shape}", allowed="one motion, >= 4 samples")
    lines = np.fft.rfft(x) * (2.0 / x.size)
    t = np.arange(samples) / rate
    total = np.zeros(samples)
    strongest = float(np.max(np.abs(lines[1:])))
    for rank in range(1, (x.size + 1) // 2):
        frequency = rank * mesh_frequency / periods
        if frequency >= 0.5 * rate or abs(lines[rank]) <= 1e-12 * strongest:
            continue
        omega = 2.0 * np.pi * frequency
        total -= omega**2 * np.real(lines[rank] * np.exp(1j * omega * t))
    return Record((Channel("simulated", total, "m/s^2"),), "simulation", rate, "simulated")
