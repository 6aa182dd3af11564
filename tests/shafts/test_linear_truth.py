"""The linear drive train against closed forms and the public truth cases L1 to L4, G1 and R1."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from trains import TRUTH, elastic, rao_train, six, stiff_bearing

from conftest import Compared
from thermogear.shafts.assembly import assemble
from thermogear.shafts.beam import BeamElements, shear_coefficient
from thermogear.shafts.linear import LinearTrain
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.train import Disc, DriveEnd, DriveTrain, GearBody, Section, Shaft

TWO_PI = 2.0 * np.pi


def beam(count: int, p: dict[str, float], length: float, diameter: float) -> np.ndarray:
    """(M, K, G) of one shaft of ``count`` elements, free at both ends."""
    made = elastic(p["E"], p.get("G", p["E"] / 2.6), p.get("density", 1e-9))
    full = np.ones(count)
    parts = BeamElements(
        length=full * length / count,
        outer_diameter=full * diameter,
        inner_diameter=0.0 * full,
        youngs_modulus=full * made.youngs_modulus,
        poisson_ratio=full * made.poisson_ratio,
        density=full * made.density,
    ).matrices()
    whole = np.zeros((3, 5 * (count + 1), 5 * (count + 1)))
    for into, part in zip(whole, parts, strict=True):
        for i in range(count):
            into[5 * i : 5 * i + 10, 5 * i : 5 * i + 10] += part[i]
    return whole


def pinned(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Bending and torsion [Hz] of L1's shaft by ``count`` elements."""
    p = TRUTH["L1"]["params"]
    mass, stiff, _ = beam(count, p, p["length"], p["outer_diameter"])
    every = np.arange(mass.shape[0])
    plane = [i for i in every if i % 5 in (0, 3) and i not in (0, 5 * count)]
    twist = [i for i in every if i % 5 == 4]
    bending, torsion = (
        scipy.linalg.eigh(stiff[np.ix_(at, at)], mass[np.ix_(at, at)], eigvals_only=True)
        for at in (plane, twist)
    )
    return np.sqrt(bending[:4]) / TWO_PI, np.sqrt(torsion[1:4]) / TWO_PI


def test_beam_meets_its_closed_form_and_truth_l1(compared: Compared) -> None:
    values = TRUTH["L1"]["values"]
    assert float(shear_coefficient(0.0, poisson_ratio=0.3125)) == pytest.approx(
        TRUTH["L1"]["params"]["shear_coefficient"], rel=1e-12
    )
    for count in (8, 16):
        known = np.asarray(values[f"fe_{count}_elements"])
        assert pinned(count)[0] == pytest.approx(known, rel=1e-9)
    coarse, fine = pinned(64), pinned(128)
    for place, name in enumerate(("bending", "torsion")):
        found = (4.0 * fine[place] - coarse[place]) / 3.0
        known = np.asarray(values[name])
        compared(f"pinned shaft, {name}", "closed form", found / known - 1.0, 1e-6)


def test_overhung_disc_whirls_as_truth_l2(compared: Compared) -> None:
    """A massless clamped Euler-Bernoulli shaft: thin and hard, so that it hardly shears."""
    case = TRUTH["L2"]
    p = case["params"]
    full = np.ones(1)
    elements = BeamElements(
        length=full * p["length"],
        outer_diameter=full * p["diameter"] / 1e3,
        inner_diameter=0.0 * full,
        youngs_modulus=full * p["E"] * 1e12,
        poisson_ratio=full * 0.3,
        density=0.0 * full,
    )
    mass, stiff, gyro = (m[0][5:9, 5:9].copy() for m in elements.matrices())
    mass[[0, 1, 2, 3], [0, 1, 2, 3]] += [p["m"], p["m"], p["Id"], p["Id"]]
    gyro[2, 3] += p["Ip"]
    gyro[3, 2] -= p["Ip"]
    for speed, known in zip(p["speeds"], case["values"]["whirl"], strict=True):
        state = np.block(
            [
                [np.zeros((4, 4)), np.eye(4)],
                [-np.linalg.solve(mass, stiff), -speed * np.linalg.solve(mass, gyro)],
            ]
        )
        value, vector = np.linalg.eig(state)
        signed = sorted(
            -np.sign(np.imag(v[0].conjugate() * v[1])) * w.imag / TWO_PI
            for w, v in zip(value, vector[:4].T, strict=True)
            if w.imag > 0.0
        )
        if speed == 0.0:
            signed = np.sort(np.abs(signed))
            known = np.abs(known)
        away = signed / np.sort(known) - 1.0
        compared(f"whirl of an overhung disc at {speed:g} rad/s", "quartic", away, 1e-6)


def test_torsional_chain_as_truth_l3(compared: Compared) -> None:
    case = TRUTH["L3"]
    inertias, springs = case["params"]["inertias"], case["params"]["stiffnesses"]
    train = rao_train(TRUTH["L4"]["params"])
    diameter, length = 0.05, 0.2
    shear = springs[1] * length / (np.pi / 32.0 * diameter**4)
    made = elastic(2.5 * shear, shear, 1e-12)
    shaft = Shaft(
        sections=(Section(length=length, outer_diameter=diameter, material=made),),
        gear_position=0.0,
    )
    none = {"mass": 1.0, "diametral_inertia": 1.0}
    own = replace(
        train,
        shafts=(shaft, train.shafts[1]),
        gears=(GearBody(polar_inertia=inertias[1], **none), train.gears[1]),
        bearings=(),
        discs=(Disc(shaft="pinion", position=length, polar_inertia=inertias[2], **none),),
        motor=DriveEnd(position=0.0, inertia=inertias[0], stiffness=springs[0]),
    )
    parts = assemble(own)
    at = [parts.index[name] for name in ("motor.tz", "pinion.0.tz", "pinion.1.tz")]
    square = scipy.linalg.eigh(
        parts.stiffness[np.ix_(at, at)], parts.mass[np.ix_(at, at)], eigvals_only=True
    )
    away = np.sqrt(square[1:]) / TWO_PI / case["values"]["frequencies"] - 1.0
    compared("free train of three discs", "closed form", away, 1e-9)


def test_two_geared_rotors_as_truth_l4(compared: Compared) -> None:
    case = TRUTH["L4"]
    parts = assemble(rao_train(case["params"]))
    springs = np.array([p.bearing.law.stiffness([0.0, 0.0]) for p in parts.bearings])
    train = LinearTrain(assembly=parts, mesh=case["params"]["k"], bearings=springs)
    for rpm, known in case["values"]["frequencies"].items():
        modes = train.modes(float(rpm) * np.pi / 30.0)
        away = modes.frequency[:12] / TWO_PI / known - 1.0
        compared(f"two geared rotors at {rpm} rpm", "elements by quadrature, ROSS 2.3", away, 1e-8)


def test_both_flanks_as_truth_g1(compared: Compared) -> None:
    p, values = TRUTH["G1"]["params"], TRUTH["G1"]["values"]
    frame = MeshFrame(
        base_radii=(p["rb1"], p["rb2"]),
        teeth=(25, 38),
        pressure_angle=np.radians(p["pressure_angle_deg"]),
        centre_line=np.radians(p["centre_line_deg"]),
        sense=p["sense"],
    )
    drive, back = frame.gaps(p["shift"])
    away = [drive - values["exact_drive"], back - values["exact_back"]]
    compared("both flanks of shifted gears", "two drawn involutes", away, 1e-12, "m")
    for column, name in zip(frame.columns, ("drive", "back"), strict=True):
        assert column == pytest.approx(values[f"vector_{name}"], abs=1e-15)
        assert column[3:5] @ p["shift"] == pytest.approx(values[f"linear_{name}"], abs=1e-15)
    pitch, metre = frame.friction_columns
    assert pitch == pytest.approx(values["friction_at_pitch"], abs=1e-15)
    assert metre == pytest.approx(values["friction_per_metre"], abs=1e-15)


def test_response_to_the_transmission_error_as_truth_r1(compared: Compared) -> None:
    case = TRUTH["R1"]
    p = case["params"]
    parts = six(p)
    springs = np.array([p["kb"] * np.eye(2)] * 2)
    train = LinearTrain(assembly=parts, mesh=p["k_mean"], bearings=springs)
    error = p["e_re"][0] + 1j * p["e_im"][0]
    w = TWO_PI * p["z1"] * p["rpm"] / 60.0
    push = (p["k_mean"] + 1j * w * train.mesh_damping) * parts.drive
    q = train.respond(w, speed=p["rpm"] * np.pi / 30.0, force=push * error)
    outputs = [parts.drive @ q, parts.back @ q, *q[[0, 1, 3, 4]]]
    known = np.asarray(case["values"]["1"]) @ [1.0, 1j]
    away = np.asarray(outputs) - known
    compared(
        "response of six coordinates", "complex solution", away, 1e-11 * np.abs(known).max(), "m"
    )


def test_two_equal_shafts_of_a_known_rig(compared: Compared) -> None:
    """Kahraman, Ozguven, Houser and Zakrajsek's rig (1992), data as recalled, by another FE.

    That one takes the shear coefficient of a solid section, 0.886; the hollow one has 0.757.
    """
    made = elastic(207e9, 79.5e9, 7800.0)
    sections = (Section(length=0.254, outer_diameter=37e-3, inner_diameter=10e-3, material=made),)
    shaft = Shaft(sections=sections, gear_position=0.127)
    body = GearBody(mass=1.84, polar_inertia=1.8e-3, diametral_inertia=0.9e-3)
    train = DriveTrain(
        frame=MeshFrame(
            base_radii=(44.5e-3, 44.5e-3), teeth=(28, 28), pressure_angle=np.radians(20.0)
        ),
        shafts=(shaft, shaft),
        gears=(body, body),
        bearings=tuple(
            stiff_bearing(f"{name} {z}", name, z, 1e9, 1e9)
            for name in ("pinion", "wheel")
            for z in (0.0, 0.254)
        ),
        least_elements=40,
    )
    parts = assemble(train)
    made_linear = LinearTrain(assembly=parts, mesh=1e8, bearings=np.array([1e9 * np.eye(2)] * 4))
    found = made_linear.modes(0.0).frequency[:9] / TWO_PI
    known = [571.5, 680.1, 680.1, 680.1, 2523.1, *[3344.9] * 4]
    compared(
        "two equal shafts of a known rig", "another FE, stiffer in shear", found / known - 1.0, 4e-3
    )
