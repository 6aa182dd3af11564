"""Two gears: both rotations, integrated as they are or rebuilt from their relative motion."""

from __future__ import annotations

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.dynamics.models import PairModel


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
            data[prefix + name] = (("point", kind), row[None, :], angle_attributes(name))
    return data


def angle_attributes(name: str) -> dict[str, str]:
    """Unit and words of one of the states of a :class:`PairModel`."""
    body = "pinion" if name.endswith("1") else "wheel"
    if name.startswith("theta"):
        return {"units": "rad", "long_name": f"vibration angle of the {body}"}
    return {"units": "rad/s", "long_name": f"vibration rate of the {body}"}
