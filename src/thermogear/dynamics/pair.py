"""Two gears: both rotations integrated as they are, or rebuilt from the exact relative motion."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.dynamics import adaptive
from thermogear.dynamics.kernels.rk4 import advance_pair
from thermogear.dynamics.models import PairModel
from thermogear.dynamics.outcome import Result, dataset


def four_of(start: Floats, model: PairModel) -> Floats:
    """The state of ``model`` that ``start`` says: whole, or by (x, x') on the line of action."""
    if start.size == 4:
        return start
    if start.shape != (2,):
        raise InputError("initial_state", f"shape {start.shape}", allowed="(x, x') or 4 numbers")
    return model.start(x=float(start[0]), v=float(start[1]))


def with_angles(data: Dataset, model: PairModel, start: Floats) -> Dataset:
    """The two rotations from x and the rigid mode, whose momentum changes with T1/r1 - T2/r2."""
    (i1, i2), (r1, r2), (t1, t2) = model.inertias, model.base_radii, model.torques
    mass = model.equivalent_mass
    push = t1 / r1 - t2 / r2
    first = float(model.momentum(start))
    level = i1 * start[0] / r1 + i2 * start[1] / r2
    for kind, prefix in (("sample", ""), ("section", "section_")):
        time = data["time" if kind == "sample" else "section_time"].values[0]
        phase = time / model.period
        rigid = level + (first + 0.5 * push * time) * time
        moving = first + push * time
        rate = model.error.derivative() * (1.0 / model.period)
        x = data[f"{prefix}x"].values[0] + model.error(phase)
        v = data[f"{prefix}v"].values[0] + rate(phase)
        values = {
            "theta1": mass * (r1 * x / i1 + rigid * r1 * r2**2 / (i1 * i2)),
            "theta2": mass * (-r2 * x / i2 + rigid * r2 * r1**2 / (i1 * i2)),
            "omega1": mass * (r1 * v / i1 + moving * r1 * r2**2 / (i1 * i2)),
            "omega2": mass * (-r2 * v / i2 + moving * r2 * r1**2 / (i1 * i2)),
        }
        for name, row in values.items():
            data[prefix + name] = (("point", kind), row[None, :], _angle_attributes(name))
    return data


def _angle_attributes(name: str) -> dict[str, str]:
    body = "pinion" if name.endswith("1") else "wheel"
    if name.startswith("theta"):
        return {"units": "rad", "long_name": f"vibration angle of the {body}"}
    return {"units": "rad/s", "long_name": f"vibration rate of the {body}"}


def simulate_pair(
    model: PairModel,
    method: str,
    start: Floats,
    *,
    periods: int,
    discard: int,
    steps: int,
    samples: int,
    tolerances: tuple[float, float],
) -> Dataset:
    """Both rotations integrated as they are: four states."""
    state = np.array(four_of(start, model), dtype=float)
    total = discard + periods
    if method == "rk4":
        phase = np.arange(2 * steps) / (2 * steps)
        rate = model.error.derivative() * (1.0 / model.period)
        tables = np.stack([model.stiffness(phase), model.error(phase), rate(phase)])
        (i1, i2), (r1, r2), (t1, t2) = model.inertias, model.base_radii, model.torques
        constants = np.array([i1, i2, r1, r2, t1, t2, model.damping, model.half_backlash])
        sections = np.empty((total, 4))
        path = np.empty((total * samples, 4))
        stride = steps // samples if samples else 1
        first = state.copy()
        advance_pair(tables, constants, model.period / steps, state, sections, path, stride)
        sections = np.vstack([first, sections])
    else:
        scale = model.half_backlash / max(model.base_radii)
        sections, path, _ = adaptive.follow(
            lambda t, y, _region: model.derivative(t, y),
            adaptive.Gap(
                lambda t, y: float(model.displacement(t, y)[0]),
                lambda t, y: float(model.displacement(t, y)[1]),
                model.half_backlash,
            ),
            model.period,
            state,
            periods=total,
            samples=samples,
            rtol=tolerances[0],
            atol=tolerances[1] * scale,
        )
    kept, path = sections[discard:], path[discard * samples :]
    result = Result(lanes=1, periods=periods, samples=samples)
    result.substeps[:] = steps if method == "rk4" else 0
    # e is periodic, so the phase within the period is enough
    within = np.tile(np.arange(samples) / samples, periods) if samples else np.empty(0)
    result.samples[0] = np.stack(model.displacement(within * model.period, path.T))
    result.sections[0] = np.stack(model.displacement(np.zeros(periods + 1), kept.T))
    data = dataset(
        result,
        period=np.array([model.period]),
        periods=periods,
        discard=discard,
        samples=samples,
        mesh_periods=model.mesh_periods,
    )
    for position, name in enumerate(("theta1", "theta2", "omega1", "omega2")):
        attributes = _angle_attributes(name)
        data[name] = (("point", "sample"), path[None, :, position], attributes)
        data["section_" + name] = (("point", "section"), kept[None, :, position], attributes)
    return data
