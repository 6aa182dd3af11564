"""``compare``: a case, or its stored results, against measured lines; and fields fitted to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, nearest
from thermogear.base.toml import held, overridden, pairs, tables
from thermogear.case.base import Case
from thermogear.case.case import gear_case, load_case
from thermogear.measured.comparison import Comparison, compared, joined, table_of
from thermogear.measured.published import (
    PUBLISHED,
    LineTable,
    Printed,
    SpeedLine,
    is_table,
    read_lines,
)
from thermogear.measured.readers import read_record
from thermogear.measured.record import Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.results.result import Notice, Result
from thermogear.study.case_runs import CaseRuns

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
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
    if u_data is not None and not 0.0 <= u_data <= 10.0:
        raise InputError("u_data", f"{100 * u_data:g} %", allowed="0..1000 %")
    for name, sigma in (tolerances or {}).items():
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
        why = "one run has no scatter" if samples < 2 else None
        raise InputError("samples", samples, allowed=f"2..{_MOST_RUNS}", why=why)
    if measured is None:
        if isinstance(simulated, str) and simulated in PUBLISHED:
            published = PUBLISHED[simulated]
            return compared(published.models, published, u_data=u_data, u_num=u_num or 0.0)
        raise InputError("measured", "nothing", fix="a record, a table or " + ", ".join(PUBLISHED))
    known = teeth or own_teeth(simulated)
    how: dict[str, Any] = {
        "at": at, "u_data": u_data, "u_num": u_num, "tolerances": tolerances, "samples": samples,
        "seed": seed,
    }  # fmt: skip
    several: list[Any] = list(measured) if isinstance(measured, (list, tuple)) else [measured]
    speeds = [speed] if speed is None or isinstance(speed, float | int) else list(speed)
    if len(speeds) not in (1, len(several)) or not several:
        raise InputError(
            "speed",
            f"{len(speeds)} speeds of {len(several)} records",
            allowed="one, or one of each",
        )
    speeds = speeds * (len(several) // len(speeds))
    found = [
        _one(simulated, one, teeth=known, speed=turns, **how)
        for one, turns in zip(several, speeds, strict=True)
    ]
    return joined(found) if len(found) > 1 else found[0]


def own_teeth(simulated: Simulated) -> int | None:
    """The pinion's teeth, where a case or the case of stored results says them."""
    if isinstance(simulated, Case):
        return gear_case(simulated).pair.pinion.teeth
    if isinstance(simulated, str | Path) and computes(simulated):
        return gear_case(load_case(simulated)).pair.pinion.teeth
    if isinstance(simulated, str | Path) and str(simulated) not in PUBLISHED:
        simulated = _stored(simulated)
    if not isinstance(simulated, Result) or not simulated.text("case"):
        return None
    changes = pairs({str(path): str(text) for path, text in simulated.values("overrides")})
    data = overridden(tables("case", simulated.text("case")), changes)
    return int(held(data, "gears.pinion.teeth")[1])


def _one(
    simulated: Simulated,
    measured: Measured,
    *,
    teeth: int | None,
    speed: float | None,
    at: Sequence[str],
    **how: Any,
) -> Comparison:
    """Simulated lines against those of one record or table."""
    if at:
        return _at_places(simulated, measured, at, teeth=teeth, speed=speed, **how)
    measured = _reduced(measured, teeth, speed)
    printed = _printed(measured, teeth, speed)
    worn = measured.damage if isinstance(measured, Measurement) else ()
    damage = [Notice(*one) for one in worn]
    u_data, u_num = how["u_data"], how["u_num"]
    if isinstance(simulated, str) and simulated in PUBLISHED:
        models = PUBLISHED[simulated].models
        return compared(models, printed, u_data=u_data, u_num=u_num or 0.0, said=damage)
    if computes(simulated):
        case: Any = simulated
        found = case_lines(
            case, how["tolerances"] or {}, samples=how["samples"], seed=how["seed"], u_num=u_num,
            speeds=[line.speed for line in printed.measured.lines],
        )  # fmt: skip
    else:
        found = CaseLines(_lines_of(simulated), u_num or 0.0, None, ())
    return compared(
        found.tables,
        printed,
        u_data=u_data,
        u_num=found.u_num,
        u_input=found.u_input,
        said=(*damage, *found.notices),
    )


def _at_places(
    simulated: Simulated,
    measured: Measured,
    at: Sequence[str],
    *,
    teeth: int | None,
    speed: float | None,
    **how: Any,
) -> Comparison:
    """The drive train of a case against the accelerometers of a record."""
    from thermogear.study.compare_sensors import compare_sensors  # drive trains are not light

    if not computes(simulated):
        raise InputError(
            "--at",
            ", ".join(at),
            why="stored results and tables do not say how a bearing moves",
            fix="name the case",
        )
    case: Any = simulated
    table = isinstance(measured, str) and measured in PUBLISHED
    if isinstance(measured, (str, Path)) and not table and not is_table(measured):
        measured = read_record(measured)
    if isinstance(measured, Record):
        measured = measure(measured, teeth=teeth, speed=speed)
    if not isinstance(measured, Measurement):
        raise InputError(
            "--at", ", ".join(at), why="a table of lines has no channels", fix="name a record"
        )
    return compare_sensors(case, measured, at, **how)


def _reduced(
    measured: Measured,
    teeth: int | None,
    speed: float | None,
) -> LineTable | Printed | Measurement | str | Path:
    """A record or its file reduced to lines; a table, its file or its name stays."""
    if isinstance(measured, (str, Path)) and measured not in PUBLISHED:
        path = Path(measured)
        if not path.is_file():
            raise InputError("measured", str(measured), fix=nearest(str(measured), PUBLISHED))
        measured = path if is_table(path) else read_record(path)
    return measure(measured, teeth=teeth, speed=speed) if isinstance(measured, Record) else measured


def _printed(
    measured: str | Path | LineTable | Printed | Measurement,
    teeth: int | None,
    speed: float | None,
) -> Printed:
    if isinstance(measured, Printed):
        return measured
    if isinstance(measured, LineTable):
        return Printed(measured, {})
    if isinstance(measured, str) and measured in PUBLISHED:
        return Printed(PUBLISHED[measured].measured, {})
    if isinstance(measured, (str, Path)):
        return Printed(read_lines(Path(measured), teeth), {})
    return Printed(table_of(measured, speed), {})


def computes(simulated: object) -> bool:
    """Whether the lines come from a case that is computed here."""
    if isinstance(simulated, (str, Path)):
        if "\n" in str(simulated):
            return True  # a case as text
        path = Path(simulated)
        return str(simulated) not in PUBLISHED and not path.is_dir() and path.suffix != ".nc"
    return not isinstance(simulated, (Mapping, Result))


def _lines_of(simulated: Simulated) -> dict[str, LineTable]:
    """Lines that are not computed here: tables as they are, or those of stored results."""
    if isinstance(simulated, Mapping):
        return {name: t for name, t in simulated.items() if isinstance(t, LineTable)}
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


@dataclass(frozen=True)
class CaseLines:
    """Tables by model, relative u_num, u_input by speed [rad/s] (None: not computed), notices."""

    tables: Mapping[str, LineTable]
    u_num: float
    u_input: Mapping[float, float] | None
    notices: tuple[Notice, ...]


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


def _motion_lines(motion: xr.Dataset) -> dict[str, LineTable]:
    first = int(np.argmin(np.abs(motion["order"].values - 1.0)))
    speeds = np.asarray(motion["pinion_speed"].values, dtype=float)
    frequency = motion["line_frequency"].isel(order=first)
    found: dict[str, LineTable] = {}
    for bundle in motion["bundle"].values:
        for state in motion["state"].values:
            here = {"bundle": bundle, "state": state}
            amplitude = motion.get("dte_line", motion["line_amplitude"]).isel(order=first).sel(here)
            lines: dict[float, SpeedLine] = {}
            columns = (speeds, frequency.values, amplitude.values)
            for speed, f, x in zip(*(map(float, one) for one in columns), strict=True):
                if np.isfinite(x) and x > 0:
                    lines.setdefault(speed, SpeedLine(speed=speed, frequency=f, displacement=x))
            if lines:
                name = f"{bundle} {state}"
                found[name] = LineTable(name, tuple(lines.values()), None, "simulation")
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


def case_lines(
    case: Case | str | Path,
    tolerances: Mapping[str, float],
    *,
    samples: int,
    seed: int,
    u_num: float | None,
    speeds: Sequence[float],
) -> CaseLines:
    """The case simulated at ``speeds`` [rad/s] of the pinion, its step doubled for u_num, and
    sampled within its tolerances."""
    runs = CaseRuns.of(case).at_speeds(speeds)
    notices: list[Notice] = []
    base = _tables(runs, {})
    if u_num is None:
        steps = runs.case({}).simulation.steps_per_period
        coarse = _tables(runs, {"simulation.steps_per_period": str(steps // 2)})
        # fourth order: the coarse run's error is 16/15 of the difference, the fine one's 1/15
        u_num = max(map(abs, _relative(base, coarse).values()), default=0.0) / 15.0
        notices.append(
            Notice(
                "info", f"u_num {100 * u_num:.3g} % from {steps} and {steps // 2} steps a period"
            )
        )
    changed = [
        [_relative(base, _tables(runs, one)) for one in several]
        for several in (runs.sampled(tolerances, count=samples, seed=seed), runs.drawings())
    ]
    u_input: dict[float, float] = {}
    for key in dict.fromkeys(key for several in changed for one in several for key in one):
        sampled, drawn = ([one[key] for one in several if key in one] for several in changed)
        spread = float(np.std(sampled, ddof=1)) if len(sampled) > 1 else 0.0
        # the greatest and not a deviation: so no drawing reverses what another decides
        most = float(np.hypot(spread, max(map(abs, drawn), default=0.0)))
        u_input[key[1]] = max(u_input.get(key[1], 0.0), most)
    return CaseLines(base, u_num, u_input, (*notices, *runs.told(tolerances)))


def _relative(
    base: Mapping[str, LineTable], other: Mapping[str, LineTable]
) -> dict[tuple[str, float], float]:
    """Ratio of the displacements less 1, by model and speed."""
    twins = {
        (name, line.speed): (line, other[name].near(line.speed))
        for name in base
        if name in other
        for line in base[name].lines
    }
    return {
        key: twin.displacement / line.displacement - 1.0
        for key, (line, twin) in twins.items()
        if twin is not None
    }
