"""The reference of drive trains against the public cases H1, N1 and N2, built by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drive_reference import Plain, Reference, Ring, closing

from conftest import Compared
from thermogear.base.excitation import Periodic
from thermogear.base.pieces import Pieces

TRUTH = json.loads((Path(__file__).parent / "drive_truth.json").read_text(encoding="utf-8"))


def series(rows: list[list[float]]) -> Periodic:
    """A function of (order, re, im)."""
    found = np.zeros(1 + max((int(row[0]) for row in rows), default=0), complex)
    for order, re, im in rows:
        found[int(order)] += re + 1j * im
    return Periodic(found[0].real, tuple(found[1:]))


def six(p: dict[str, Any], **changes: Any) -> Plain:
    """Two masses on a ring bearing each, over (x1, y1, x2, y2, p = r_b1 th1 + r_b2 th2)."""
    alpha, (r1, r2), (i1, i2) = (
        np.radians(p["alpha_deg"]),
        (p["rb1"], p["rb2"]),
        (p["I1"], p["I2"]),
    )
    assert p["phi_deg"] == 0.0
    n = np.array([np.sin(alpha), np.cos(alpha)])
    mirrored = n * [1.0, -1.0]
    me = i1 * i2 / (i1 * r2**2 + i2 * r1**2)
    drive, back = np.r_[n, -n, 1.0], np.r_[mirrored, -mirrored, -1.0]
    cm = 2.0 * p["zeta_mesh"] * np.sqrt(p["k_mean"] * me)
    damping = p["cb"] * np.diag([1.0, 1.0, 1.0, 1.0, 0.0]) + cm * np.outer(drive, drive)
    across = np.array([-n[1], n[0]])
    arms = np.tan(alpha) * np.array([r1, r2])

    def twisting(first: float, second: float) -> float:
        return float(me * (r1 * first / i1 + r2 * second / i2))

    ring = {"coefficient": p["kb"], "exponent": p["exponent"], "clearance": p["clearance"]}
    made: dict[str, Any] = {
        "mass": np.diag([p["m1"], p["m1"], p["m2"], p["m2"], me]),
        "damping": damping,
        "stiffness": np.zeros((5, 5)),
        "force": np.r_[0.0, 0.0, 0.0, 0.0, p["T1"] / r1],
        "drive": drive,
        "back": back,
        "mesh_stiffness": Periodic(
            p["k_mean"], tuple(np.asarray(p["k_re"]) + 1j * np.asarray(p["k_im"]))
        ),
        "error": Periodic(0.0, tuple(np.asarray(p["e_re"]) + 1j * np.asarray(p["e_im"]))),
        "half_backlash": p["b"],
        "mesh_damping": cm,
        "mesh_frequency": p["z1"] * p["rpm"] / 60.0,
        "bearings": tuple(Ring(directions=np.eye(5)[:, at], **ring) for at in ([0, 1], [2, 3])),
    }
    if p["chi0"]:
        pitch = np.r_[-across, across, twisting(-arms[0], -arms[1])]
        metre = np.r_[np.zeros(4), twisting(-1.0, 1.0)]
        made |= {
            "friction": np.stack([pitch, metre]),
            "friction_at_pitch": series(p["chi0"]),
            "friction_per_metre": series(p["chi1"]),
        }
    return Plain(**(made | changes))


def outputs(p: Plain) -> np.ndarray:
    """delta_d, delta_b, x1, y1, x2, y2 of the coordinates."""
    return np.vstack([p.drive, p.back, np.eye(5)[:4]])


@pytest.mark.parametrize("name", ["N1", "N2"])
def test_public_sections_come_back(name: str, compared: Compared) -> None:
    case = TRUTH[name]
    p, values = six(case["params"]), case["values"]
    rows = outputs(p)
    section = [np.asarray(values["section"][part]) for part in ("y", "ydot")]
    start = np.concatenate([np.linalg.lstsq(rows, one, rcond=None)[0] for one in section])
    reference = Reference(p)
    end = reference.after(start, values["periods"])
    for one, part, within, unit in zip(
        section, (end[:5], end[5:]), (1e-15, 1e-10), ("m", "m/s"), strict=True
    ):
        what = f"section of a drive train ({name}) after its periods"
        compared(what, "public truth", rows @ part - one, within, unit)
    assert len(reference.changes) == values["dop853_events"]


def test_friction_of_the_teeth_as_truth_h1(compared: Compared) -> None:
    case = TRUTH["H1"]
    p = six(case["params"])
    rest = np.linalg.lstsq(
        outputs(p), np.array([row[0] for row in case["values"]["0"]]) @ np.eye(6), rcond=None
    )[0]
    start = closing(p, Reference(p).after(np.r_[rest, np.zeros(5)], 2))
    count = 32
    times = np.arange(count) / (count * p.mesh_frequency)
    motion = Reference(p).states(start, times)[:, :5] @ outputs(p).T
    lines = np.fft.rfft(motion, axis=0) / count
    lines[1:] *= 2.0
    for order in range(7):
        known = np.asarray(case["values"][str(order)]) @ [1.0, 1j]
        what = f"drive train with friction, order {order}"
        compared(what, "harmonic balance", lines[order] - known, 2e-15, "m")


def test_friction_that_jumps_is_stopped_at() -> None:
    """Pieces, and the same pieces with one more border where nothing jumps."""
    case = TRUTH["H1"]["params"]
    starts, values = [0.0, 0.3, 0.7], np.array([0.05, -0.03, 0.02])
    ends = []
    for own, there in ((starts, values), ([0.0, 0.3, 0.5, 0.7], values[[0, 1, 1, 2]])):
        pitch = Pieces.constant(starts=own, values=there)
        p = six(
            case,
            friction_at_pitch=pitch,
            friction_per_metre=Pieces.constant(starts=own, values=1e-3 * there),
        )
        rest = np.linalg.lstsq(p.drive[None], [4.5e-5], rcond=None)[0]
        ends.append(Reference(p).after(np.r_[rest, np.zeros(5)], 3))
    assert ends[1] == pytest.approx(ends[0], rel=1e-9, abs=1e-15)
