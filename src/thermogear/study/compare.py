"""``compare``: a case, or its stored results, against measured lines; and fields fitted to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError, nearest
from thermogear.case.base import Case
from thermogear.case.case import gear_case, load_case
from thermogear.measured.comparison import Comparison, compared, table_of
from thermogear.measured.published import (
    PUBLISHED,
    LineTable,
    Printed,
    SpeedLine,
    is_table,
    read_lines,
    together,
)
from thermogear.measured.readers import read_record
from thermogear.measured.record import Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.results.result import Notice, Result
from thermogear.study.case_runs import CaseRuns
from thermogear.study.declared import fault_notices
from thermogear.study.series import Spread

Simulated: TypeAlias = str | Path | Case | Result | Mapping[str, LineTable]
Measured: TypeAlias = str | Path | LineTable | Printed | Measurement | Record

_MOST_RUNS = 10_000


def compare(
    simulated: Simulated,
    measured: Measured | Sequence[Measured] | None = None,
    *,
    teeth: int | None = None,
    speed: float | Sequence[float | None] | None = None,
    at: Sequence[str] = (),
    u_data: float | None = None,
    u_num: float | None = None,
    tolerances: Mapping[str, float] | None = None,
    samples: int = 12,
    seed: int = 0,
) -> Comparison:
    """Simulated lines against measured ones: errors, u_val, verdicts, what the lines imply.

    ``simulated``: a case or its file, simulated here at the speeds that were measured; stored
    results, or tables by model name.
    ``measured``: a table (``LineTable``, a CSV of lines, or the name of a published one as
    "thesis-5.2"), or a record, its file or its ``Measurement``; or several of these, in one table
    with one verdict on heat. ``speed`` [rad/s]: the pinion's in a record, one for all or one for
    each; left out, as its mesh line and the ``teeth`` imply, those of the case where none are
    given. ``simulated`` may be "thesis-5.2" alone: the thesis's own table recomputed.
    ``u_data`` relative standard uncertainty of the measurement where the data do not state it,
    ``u_num`` of the simulation (for a case: found by halving the step unless given);
    ``tolerances``: relative standard uncertainty per field of the case, as
    {"operating.torque": 0.05}, sampled ``samples`` times from ``seed``.
    ``at``: where the record's accelerometers sit on a case with shafts, a text for each channel as
    "a1=bearing:pinion left:x"; then their mesh lines are compared with the drive train's at the
    same place, and not the teeth's displacement.

    Raises InputError when no speed is common to both sides, or an uncertainty is impossible.
    """
    _require(simulated, u_data, tolerances or {}, samples)
    if measured is None:
        if isinstance(simulated, str) and simulated in PUBLISHED:
            published = PUBLISHED[simulated]
            return compared(published.models, published, u_data=u_data, u_num=u_num or 0.0)
        raise InputError("measured", "nothing", fix="a record, a table or " + ", ".join(PUBLISHED))
    several: list[Any] = list(measured) if isinstance(measured, (list, tuple)) else [measured]
    speeds = speeds_of(speed, len(several))
    known = teeth or own_teeth(simulated)
    read = [_read(one, known, turns) for one, turns in zip(several, speeds, strict=True)]
    case: Any = simulated
    if at:
        from thermogear.study.compare_sensors import compare_sensors  # drive trains are not light

        if not computes(simulated):
            why = "stored results and tables do not say how a bearing moves"
            raise InputError("--at", ", ".join(at), why=why, fix="name the case")
        if len(read) > 1 or not isinstance(read[0], Measurement):
            why = "several records" if len(read) > 1 else "a table of lines has no channels"
            raise InputError("--at", ", ".join(at), why=why, fix="name a record")
        return compare_sensors(
            case, read[0], at, u_data=u_data, u_num=u_num, tolerances=tolerances, samples=samples,
            seed=seed,
        )  # fmt: skip
    damage = [told for one in read if isinstance(one, Measurement) for told in one.findings]
    printed = [
        Printed(table_of(one, turns), {}) if isinstance(one, Measurement) else one
        for one, turns in zip(read, speeds, strict=True)
    ]
    against = (
        printed[0] if len(printed) == 1 else Printed(together([p.measured for p in printed]), {})
    )
    if computes(simulated):
        turning = [line.speed for line in against.measured.lines]
        lines = case_lines(
            case, tolerances or {}, samples=samples, seed=seed, u_num=u_num, speeds=turning
        )
    else:
        lines = {"models": _lines_of(simulated), "u_num": u_num or 0.0}
    said = (*damage, *lines.pop("notices", ()))
    return compared(printed=against, u_data=u_data, said=said, **lines)


def speeds_of(speed: float | Sequence[float | None] | None, count: int) -> list[float | None]:
    """The speed of each of ``count`` records: one for all, or one of each."""
    speeds = list(speed) if isinstance(speed, Sequence) else [speed] * count
    if len(speeds) != count:
        told = f"{len(speeds)} speeds of {count} records"
        raise InputError("speed", told, allowed="one, or one of each")
    return speeds


def _require(
    simulated: Simulated, u_data: float | None, tolerances: Mapping[str, float], samples: int
) -> None:
    """Refuse impossible uncertainties, before anything is read."""
    if u_data is not None and not 0.0 <= u_data <= 10.0:
        raise InputError("u_data", f"{100 * u_data:g} %", allowed="0..1000 %")
    for name, sigma in tolerances.items():
        if not 0.0 <= sigma <= 1.0:
            raise InputError(f"tolerance of {name}", f"{100 * sigma:g} %", allowed="0..100 %")
    if tolerances and not computes(simulated):
        raise InputError(
            "tolerances",
            ", ".join(tolerances),
            why="stored lines are not computed anew",
            fix="name the case instead of its results",
        )
    if tolerances and not 2 <= samples <= _MOST_RUNS:
        raise InputError(
            "samples", samples, allowed=f"2..{_MOST_RUNS}",
            why="one run has no scatter" if samples < 2 else None,
        )  # fmt: skip


def own_teeth(simulated: Simulated) -> int | None:
    """The pinion's teeth, where a case or the case of stored results says them."""
    case: Any = simulated
    if not computes(simulated):
        named = isinstance(simulated, str | Path) and str(simulated) not in PUBLISHED
        stored = _stored(str(simulated)) if named else simulated
        if not isinstance(stored, Result) or not stored.text("case"):
            return None
        changes = {str(path): str(text) for path, text in stored.values("overrides")}
        case = load_case(stored.text("case"), changes)
    return gear_case(load_case(case) if isinstance(case, str | Path) else case).pair.pinion.teeth


def _read(measured: Measured, teeth: int | None, speed: float | None) -> Printed | Measurement:
    """A record or its file reduced to lines; a table by its name, its file, or itself."""
    if isinstance(measured, (str, Path)):
        path = Path(measured)
        if str(measured) in PUBLISHED:
            return Printed(PUBLISHED[str(measured)].measured, {})
        if not path.is_file():
            fix = nearest(path.name, PUBLISHED)
            raise InputError("measured", str(measured), why="there is no such file", fix=fix)
        measured = read_lines(path, teeth) if is_table(path) else read_record(path)
    if isinstance(measured, Record):
        return measure(measured, teeth=teeth, speed=speed)
    return Printed(measured, {}) if isinstance(measured, LineTable) else measured


def computes(simulated: object) -> bool:
    """Whether the lines come from a case that is computed here."""
    if isinstance(simulated, (str, Path)):
        if "\n" in str(simulated):
            return True  # a case as text
        path = Path(simulated)
        return str(simulated) not in PUBLISHED and not path.is_dir() and path.suffix != ".nc"
    return not isinstance(simulated, (Mapping, Result))


def _lines_of(simulated: Simulated) -> Mapping[str, LineTable]:
    """Lines that are not computed here: tables as they are, or those of stored results."""
    if isinstance(simulated, str) and simulated in PUBLISHED:
        return PUBLISHED[simulated].models
    if isinstance(simulated, Mapping):
        return {name: one for name, one in simulated.items() if isinstance(one, LineTable)}
    stored: Any = simulated
    return tree_lines(stored if isinstance(stored, Result) else _stored(stored))


def _stored(simulated: str | Path) -> Result:
    """The results in a directory, or a file."""
    path = Path(simulated)
    stored = path / "results.nc" if path.is_dir() else path
    if not stored.is_file():
        raise InputError(
            "simulated",
            str(simulated),
            why="there are no results",
            fix="make them by `thermogear run`, or name a case",
        )
    return Result.read(stored)


def tree_lines(result: Result) -> dict[str, LineTable]:
    """The mesh line of the transmission error, one table per bundle and state ("thesis hot").

    That of x + e, the movement of one base circle against the other: what a model takes for the
    error e of its flanks and what for their deflection x is its own.

    Operating points without a motion (jammed, diverged) are left out; of several torques at one
    speed the first stands for it.
    """
    motion = result.group("motion")
    if motion is None:
        raise InputError("simulated", "no motion", fix='draw.pictures must hold "motion"')
    return _motion_lines(motion)


def _motion_lines(motion: Dataset) -> dict[str, LineTable]:
    first = int(np.argmin(np.abs(motion["order"].values - 1.0)))
    speeds = np.asarray(motion["pinion_speed"].values, dtype=float)
    frequency = motion["line_frequency"].isel(order=first)
    found: dict[str, LineTable] = {}
    for bundle in motion["bundle"].values:
        for state in motion["state"].values:
            here = {"bundle": bundle, "state": state}
            amplitude = motion.get("dte_line", motion["line_amplitude"]).isel(order=first).sel(here)
            columns = (one[::-1].tolist() for one in (speeds, frequency.values, amplitude.values))
            # of several torques at one speed the first stands for it
            lines = {
                speed: SpeedLine(speed=speed, frequency=f, displacement=x)
                for speed, f, x in zip(*columns, strict=True)
                if np.isfinite(x) and x > 0
            }
            if lines:
                name = f"{bundle} {state}"
                found[name] = LineTable(name, tuple(lines.values())[::-1], None, "simulation")
    if not found:
        raise InputError(
            "simulated",
            "no line",
            why="no operating point has a motion",
            fix="look for jams by `thermogear check` and `thermogear run`, or change the backlash",
        )
    return found


def _tables(runs: CaseRuns, changes: Mapping[str, str]) -> dict[str, LineTable]:
    from thermogear.study.run import gear_motion  # stored lines and tables need none

    return _motion_lines(gear_motion(runs.case(changes)))


def _spread(parts: Sequence[Mapping[str, LineTable]], name: str, speed: float) -> Spread:
    """How the lines [m] of ``parts`` differ at a speed, by the model ``name``."""
    near = [part[name].near(speed) for part in parts if name in part]
    return Spread.of(np.array([line.displacement for line in near if line is not None]))


def _median(parts: Sequence[Mapping[str, LineTable]]) -> dict[str, LineTable]:
    """The median line of ``parts`` at each speed of the first, by model."""
    return {
        name: replace(
            table,
            lines=tuple(
                replace(line, displacement=_spread(parts, name, line.speed).middle.value)
                for line in table.lines
            ),
        )
        for name, table in parts[0].items()
    }


def case_lines(
    case: Case | str | Path,
    tolerances: Mapping[str, float],
    *,
    samples: int,
    seed: int,
    u_num: float | None,
    speeds: Sequence[float],
) -> dict[str, Any]:
    """The case simulated at ``speeds`` [rad/s] of the pinion, its step doubled for u_num, and
    sampled within its tolerances: its models, u_num, u_input by speed, and notices.

    Of a series the models are the median of its parts, u_input the greatest change that one makes.
    """
    runs = CaseRuns.of(case).at_speeds(speeds)
    stated, drawings = runs.case({}), runs.drawings()
    notices = [*fault_notices(stated)]
    if stated.series > 1:  # steps and tolerances are tried on one part
        runs = replace(runs, kept={**runs.kept, **drawings[0]})
    alone = _tables(runs, {})
    if u_num is None:
        steps = stated.simulation.steps_per_period
        coarse = _tables(runs, {"simulation.steps_per_period": str(steps // 2)})
        # fourth order: the coarse run's error is 16/15 of the difference, the fine one's 1/15
        u_num = max(map(abs, _relative(alone, coarse).values()), default=0.0) / 15.0
        notices.append(Notice.of("u_num_of_steps", u_num=u_num, steps=[steps, steps // 2]))
    sampled = [
        _relative(alone, _tables(runs, one))
        for one in runs.sampled(tolerances, count=samples, seed=seed)
    ]
    parts = [_tables(runs, one) for one in drawings]
    base = _median(parts) if stated.series > 1 else alone
    drawn = [_relative(base, part) for part in parts]
    u_input: dict[float, float] = {}
    for key in dict.fromkeys(key for one in (*sampled, *drawn) for key in one):
        scatter = [one[key] for one in sampled if key in one]
        spread = float(np.std(scatter, ddof=1)) if len(scatter) > 1 else 0.0
        # the greatest and not a deviation: so no drawing reverses what another decides
        most = max((abs(one[key]) for one in drawn if key in one), default=0.0)
        u_input[key[1]] = max(u_input.get(key[1], 0.0), float(np.hypot(spread, most)))
    if stated.series > 1:
        name, table = list(base.items())[-1]
        bands = [_spread(parts, name, line.speed) for line in table.lines]
        notices.append(
            Notice.of(
                "measured_part_of_class",
                parts=len(parts),
                accuracy=stated.accuracy,
                model=name,
                bands=[[band.low.value, band.high.value] for band in bands],
                speeds=[line.speed for line in table.lines],
            )
        )
    notices += runs.told(tolerances, len(drawings))
    return {"models": base, "u_num": u_num, "u_input": u_input, "notices": notices}


def _relative(
    base: Mapping[str, LineTable], other: Mapping[str, LineTable]
) -> dict[tuple[str, float], float]:
    """Ratio of the displacements less 1, by model and speed."""
    return {
        (name, line.speed): twin.displacement / line.displacement - 1.0
        for name in base
        if name in other
        for line in base[name].lines
        if (twin := other[name].near(line.speed)) is not None
    }
