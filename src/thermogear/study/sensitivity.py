"""Which input that nobody stated decides which conclusion: a variance-based study of the chain.

Every unstated input runs through a range; first-order and total indices (Sobol', Saltelli's
sampling, bootstrap confidence intervals) say what share of a result's variance each brings.
Needs the extra ``sensitivity`` (SALib), imported when used.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ValidityWarning, nearest, of_extra
from thermogear.base.progress import Progress, silent
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS
from thermogear.case.build import Follows, TemperatureRule
from thermogear.case.case import GearCase, gear_case
from thermogear.case.points import Points, points_of
from thermogear.case.samples import fields_of, quasi_static, sampled
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.dynamics.integrate import simulate
from thermogear.gears.turn import mean_tooth
from thermogear.mesh.excite import EXCITES
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Temperatures
from thermogear.results.result import Result, now
from thermogear.study.declared import Sensitivity, declared
from thermogear.study.series import series_parts
from thermogear.study.watched import (
    INPUTS,
    OUTPUTS,
    PART,
    Input,
    Output,
    first,
    inputs_of,
    outputs_of,
    state_of,
)

PATH, PHASES, HARMONICS = 41, 64, 16
DISCARD, PERIODS, SAMPLES = 300, 8, 64
LANES = 1024

OF_THE_PATH = (
    "friction_coefficient_mixed", "flash_temperature_mixed", "flash_temperature_dry",
    "deformation_sum",
)  # fmt: skip
"""What the outputs take along the path of contact."""


FIELDS: dict[str, tuple[str, ...]] = {one.name: fields_of(one.parameter.name) for one in INPUTS} | {
    "gear": ("temperatures.pinion_addendum", "temperatures.wheel_addendum"),
    PART.name: (PART.name,),
}
"""The columns that an input stands for."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """The study: ``samples`` base samples N (a power of two; N (inputs + 2) evaluations).

    Below about 100 base samples the bootstrap's intervals are too narrow themselves.
    ``speed`` [rad/s] of the pinion (None: the case's middle one), ``inputs`` with their ranges,
    ``resamples`` of the bootstrap, ``confidence`` of its intervals, ``seed``.
    """

    samples: int = Sensitivity.samples
    speed: float | None = None
    inputs: tuple[Input, ...] = INPUTS
    resamples: int = 200
    confidence: float = 0.95
    seed: int = Sensitivity.seed

    def __post_init__(self) -> None:
        if self.samples < 8 or self.samples & (self.samples - 1):
            raise InputError("samples", self.samples, allowed="a power of two, 8 or more")
        if not 0 <= self.seed < 2**32:
            raise InputError("seed", self.seed, allowed="0..4294967295, whole")
        if self.speed is not None and self.speed <= 0.0:
            raise InputError("speed", f"{self.speed / RPM:g} rpm", allowed="> 0 rpm")
        if not 0.0 < self.confidence < 1.0:
            raise InputError("confidence", self.confidence, allowed="0 < confidence < 1")
        known = [*FIELDS]
        for one in self.inputs:
            if one.name not in known:
                raise InputError("inputs", repr(one.name), fix=nearest(one.name, known))
            if not one.low < one.high:
                raise InputError(f"inputs.{one.name}", f"{one.low} .. {one.high}", allowed="rising")

    @property
    def evaluations(self) -> int:
        """How often the chain is computed."""
        return self.samples * (len(self.inputs) + 2)


def salib(module: str) -> Any:
    """A module of SALib, or an error that says how to install it."""
    return of_extra(
        f"SALib.{module}", "sensitivity", field="sensitivity", got="Sobol indices", use="it"
    )


def require_salib() -> None:
    """Refuse in one line where SALib is missing, before anything is computed."""
    salib("sample.sobol")


def sensitivity(case: GearCase, plan: Plan | None = None, *, progress: Progress = silent) -> Result:
    """Sobol' indices of every output for every input of a gear case, with their intervals.

    Indices are shares [-]; inputs and outputs are in SI.

    First order: the share of the variance an input brings alone; total: with everything it does
    together with others. Inputs are independent and uniform in their ranges (viscosity in its
    logarithm). Each sample computes the chain cold and hot with the consistent bundle (and the
    thesis's for its stiffness) at one speed, and the settled vibration. A jammed pair has swing
    0 and counts in ``jammed``. ``plan`` defaults to the ranges of :func:`inputs_of`. Raises
    InputError where samples have no mesh at all: the ranges then reach too far.

    Returns a dataset over (output, input): ``first_order``, ``total`` with ``..._conf`` (half
    width), per output ``mean``, ``low``, ``high`` (5 and 95 % of the samples), ``holds`` (share
    of samples in which the conclusion holds) in shown units; attributes: evaluations, seconds.
    """
    chosen = Plan(inputs=inputs_of(gear_case(case))) if plan is None else plan
    outputs = outputs_of(case)
    sampler, analyser = salib("sample.sobol"), salib("analyze.sobol")
    problem = {
        "num_vars": len(chosen.inputs),
        "names": [one.name for one in chosen.inputs],
        "bounds": [[0.0, 1.0]] * len(chosen.inputs),
    }
    began = time.perf_counter()
    places = sampler.sample(problem, chosen.samples, calc_second_order=False, seed=chosen.seed)
    values, jammed = evaluate(case, chosen, places, progress)
    seconds = time.perf_counter() - began
    shape = (len(outputs), len(chosen.inputs))
    indices = {name: np.zeros(shape) for name in ("S1", "S1_conf", "ST", "ST_conf")}
    for row, output in enumerate(outputs):
        y = values[output.name]
        if np.ptp(y) <= 1e-12 * max(float(np.abs(y).max()), 1e-300):
            continue  # nothing decides what never changes
        found = analyser.analyze(
            problem,
            y,
            calc_second_order=False,
            num_resamples=chosen.resamples,
            conf_level=chosen.confidence,
            seed=chosen.seed,
        )
        for name, table in indices.items():
            table[row] = found[name]
    data = _dataset(case, chosen, outputs, values, indices, jammed, seconds)
    words = data.assign(sentence=(("output",), plain_words(data)))
    return Result.of(
        Sensitivity.kind, f"Sensitivity: {case.title}", {"sensitivity": words}, created=now()
    )


@declared(Sensitivity)
def sensitivity_around(
    case: GearCase,
    *,
    samples: int = Sensitivity.samples,
    speed: float | None = None,
    seed: int = Sensitivity.seed,
    progress: Progress = silent,
) -> Result:
    """The same with inputs in ranges around those of the case; ``speed`` [rad/s] as of a plan."""
    plan = Plan(samples=samples, speed=speed, seed=seed, inputs=inputs_of(case))
    return sensitivity(case, plan, progress=progress)


def _dataset(
    case: GearCase,
    plan: Plan,
    outputs: tuple[Output, ...],
    values: dict[str, Floats],
    indices: dict[str, Floats],
    jammed: int,
    seconds: float,
) -> xr.Dataset:
    two = ("output", "input")
    one = ("output",)
    shown = [values[o.name] * o.scale for o in outputs]
    share = {"units": "1"}
    return xr.Dataset(
        {
            "first_order": (two, indices["S1"], {"long_name": "first-order index", **share}),
            "first_order_conf": (two, indices["S1_conf"], {"long_name": "half width", **share}),
            "total": (two, indices["ST"], {"long_name": "total index", **share}),
            "total_conf": (two, indices["ST_conf"], {"long_name": "half width", **share}),
            "mean": (one, [float(y.mean()) for y in shown]),
            "low": (one, [float(np.quantile(y, 0.05)) for y in shown]),
            "high": (one, [float(np.quantile(y, 0.95)) for y in shown]),
            "holds": (
                one,
                [
                    float(o.holds(values[o.name]).mean()) if o.conclusion else np.nan
                    for o in outputs
                ],
                share,
            ),
            "output_words": (one, [o.words for o in outputs]),
            "output_unit": (one, [o.unit for o in outputs]),
            "conclusion": (one, [o.conclusion for o in outputs]),
            "input_words": (("input",), [i.parameter.words for i in plan.inputs]),
            "input_unit": (("input",), [i.unit for i in plan.inputs]),
            "input_low": (("input",), [i.parameter.show(i.low) for i in plan.inputs]),
            "input_high": (("input",), [i.parameter.show(i.high) for i in plan.inputs]),
        },
        {
            "output": [o.name for o in outputs],
            "input": [i.name for i in plan.inputs],
        },
        {
            "title": case.title,
            "evaluations": plan.evaluations,
            "samples": plan.samples,
            "confidence": plan.confidence,
            "seconds": seconds,
            "jammed": jammed,
            "speed": _speed(case, plan),
            "seed": plan.seed,
        },
    )


def _speed(case: GearCase, plan: Plan) -> float:
    return float(case.speeds[len(case.speeds) // 2]) if plan.speed is None else float(plan.speed)


def evaluate(
    case: GearCase, plan: Plan, places: Floats, progress: Progress = silent
) -> tuple[dict[str, Floats], int]:
    """Every output at ``places`` (sample, input) of the unit cube, and how many pairs jam.

    One mesh cycle takes all samples of a part at once (:mod:`thermogear.case.samples`).
    """
    count = len(places)
    columns = {
        field: one.values(places[:, k])
        for k, one in enumerate(plan.inputs)
        for field in FIELDS[one.name]
    }
    columns["operating.speed"] = np.full(count, _speed(case, plan))
    held, number = _held(case), columns.pop(PART.name, np.zeros(count)).astype(int)
    number *= case.series > 1
    drawn = series_parts(case, int(number.max()) + 1) if case.series > 1 else [held.deviations]
    parts = [mean_tooth(case.pair, part) for part in drawn]
    consistent, thesis = MeshModel.consistent(), MeshModel.thesis()
    stiffness = (*EXCITES, "mean_stiffness")

    def cycle(model: MeshModel, state: ThermalState, want: Sequence[str]) -> dict[str, Floats]:
        found: dict[str, NDArray[Any]] = {}
        # textbook springs know of no part
        group = number if model.stiffness == "loaded" else np.zeros(count, int)
        for part in np.unique(group):
            rows = np.flatnonzero(group == part)
            some = {name: values[rows] for name, values in columns.items()}
            made = replace(held, deviations=parts[part])
            here = quasi_static(made, some, rows.size, model, state, want, path_positions=PATH)
            for name, values in here.items():
                found.setdefault(name, np.empty((count, *values.shape[1:]), values.dtype))
                found[name][rows] = values
        done.append(state)
        progress("sensitivity", len(done), 5)
        return found

    done: list[ThermalState] = []
    progress("sensitivity", 0, 5)
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        # corners of the ranges leave an oil's range; the ranges stand beside the results
        cold = cycle(consistent, UNDEFORMED, stiffness)
        hot = cycle(consistent, HOT, (*stiffness, *OF_THE_PATH))
        _require_meshes(hot)
        printed = [cycle(thesis, state, ("mean_stiffness",)) for state in (UNDEFORMED, HOT)]
    flash = {kind: hot[f"flash_temperature_{kind}"].max(axis=1) for kind in ("mixed", "dry")}
    values = {output.name: np.zeros(count) for output in OUTPUTS} | {
        "stiffness_change": hot["mean_stiffness"] / cold["mean_stiffness"] - 1.0,
        "stiffness_change_thesis": printed[1]["mean_stiffness"] / printed[0]["mean_stiffness"] - 1,
        "friction": hot["friction_coefficient_mixed"].mean(axis=1),
        "flash": flash["mixed"],
        "dry_over_mixed": flash["dry"] / flash["mixed"],
        "growth": hot["deformation_sum"].mean(axis=1),
        "backlash_left": hot["half_backlash"] / hot["cold_half_backlash"],
    }
    samples = sampled(held, columns, count)
    both = [points_of(samples.excited(found)) for found in (cold, hot)]
    moving = np.flatnonzero(~(both[0].still | both[1].still))
    values["frequency_ratio"][moving] = (both[1].mesh_frequency / both[1].rate)[moving]
    for start in range(0, moving.size, LANES):
        _vibrate(both, moving[start : start + LANES], values)
    progress("sensitivity", 5, 5)
    return values, count - moving.size


def _require_meshes(hot: Mapping[str, NDArray[Any]]) -> None:
    """Refuse ranges in which some samples have no mesh."""
    lost = int(np.count_nonzero(hot["status"] == STATUS.index("not_converged")))
    if lost:
        raise InputError(
            "inputs",
            f"ranges in which {lost} of {hot['status'].size} samples have no mesh",
            why="no case could have these values, or the loaded contact does not settle",
            fix="take narrower ranges",
        )


def _held(case: GearCase) -> GearCase:
    """The case as hot as it is, bores, housing and oil so far below the gears as they are."""
    at = state_of(case)
    given = at.temperatures
    tip = first(given.pinion_addendum)

    def below(value: object) -> Follows:
        return Follows(tip - first(value), True)

    rule = TemperatureRule(
        given.reference,
        pinion_bore=below(given.pinion_bore),
        wheel_bore=below(given.wheel_bore),
        housing=below(given.housing),
        oil=below(at.oil_temperature),
    )
    both = Temperatures.uniform(tip, reference=given.reference)
    return replace(
        case,
        computed=False,
        temperature_rule=rule,
        stated=replace(case.stated, temperatures=both),
        mesh_positions=PHASES,
        harmonics=HARMONICS,
    )


def _vibrate(both: list[Points], some: NDArray[np.int64], values: dict[str, Floats]) -> None:
    """Settled swing and loss of contact of ``some`` samples at once, undeformed and hot."""
    swings = []
    for whole in both:
        points = whole.take(some)
        data = simulate(
            points,
            discard=DISCARD,
            periods=PERIODS,
            samples_per_period=SAMPLES,
            initial_state=(1.0, 0.0),
        )
        swings.append(np.ptp(data["x"].values, axis=1) * points.length)
        lost = 1.0 - data["time_share"].sel(side="drive").values
    cold_swing, hot_swing = swings
    values["swing"][some] = hot_swing
    values["swing_change"][some] = hot_swing / cold_swing - 1.0
    values["out_of_contact"][some] = np.where(lost > 1e-9, lost, 0.0)


def ranking(data: xr.Dataset, output: str) -> list[tuple[str, float, float]]:
    """(words of the input, total index, half width of its interval), the strongest first."""
    here = data.sel(output=output)
    order = np.argsort(-here["total"].values, kind="stable")
    return [
        (
            str(here["input_words"].values[k]),
            float(here["total"].values[k]),
            float(here["total_conf"].values[k]),
        )
        for k in order
    ]


def plain_words(data: xr.Dataset) -> list[str]:
    """One sentence for every output: what decides it, and how often its conclusion holds."""
    found = []
    for place, output in enumerate(data["output"].values):
        here = data.isel(output=place)
        rows = ranking(data, str(output))
        deciding = [row for row in rows if row[1] - row[2] > 0.05][:4]
        low, high = (f"{here[end].item():.3g}" for end in ("low", "high"))
        span = f"{low} to {high} {here['output_unit'].item()}"
        span = span.removesuffix(" –")
        if not deciding:
            still = float(here["total"].max()) == 0.0
            why = "no input changes it" if still else "too few samples to say what decides it"
            text = f"{here['output_words'].item()}: {span}; {why}."
        else:
            names = ", ".join(f"{w} ({100 * t:.0f} ± {100 * c:.0f} %)" for w, t, c in deciding)
            rest = [w for w, t, c in rows if t + c < 0.01]
            text = f"{here['output_words'].item()}: {span}; decided by {names}"
            text += f"; {len(rest)} of {len(rows)} inputs do not matter." if rest else "."
        if here["conclusion"].item():
            holds = 100.0 * float(here["holds"])
            text += f" That {here['conclusion'].item()} holds in {holds:.0f} % of cases."
        found.append(text)
    return found
