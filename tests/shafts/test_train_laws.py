"""Laws that a linear drive train and its equilibrium keep, on seeded random trains."""

from dataclasses import replace

import numpy as np
import pytest
from trains import TRUTH, lumped, random_train, six

from conftest import Compared
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.shafts.assembly import Assembly, assemble
from thermogear.shafts.bearings.laws import ElementLaw, LinearLaw, RingLaw
from thermogear.shafts.linear import LinearTrain, damping_ratios, lift_off, strain_shares, whirl
from thermogear.shafts.response import (
    error_response,
    loaded_error,
    run_out_error,
    unbalance_response,
)
from thermogear.shafts.statics import equilibrium
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    Casing,
    Damping,
    DriveTrain,
    RunOut,
    Seat,
    Section,
    Shaft,
    Unbalance,
)

RANDOM = 6


def own(stiff: float) -> LinearLaw:
    return LinearLaw(stiffness_matrix=((stiff, 0.0), (0.0, stiff)))


def trains(seed: int, **changes: object) -> list[DriveTrain]:
    rng = np.random.default_rng(seed)
    return [random_train(rng, **changes) for _ in range(RANDOM)]


def isotropic(train: DriveTrain, stiff: float = 2e8) -> DriveTrain:
    bearings = tuple(replace(one, law=own(stiff), damping=500.0) for one in train.bearings)
    return replace(train, bearings=bearings)


def linear(train: DriveTrain, mesh: float = 3e8) -> LinearTrain:
    parts = assemble(train)
    springs = np.array([p.bearing.law.stiffness([0.0, 0.0]) for p in parts.bearings])
    return LinearTrain(assembly=parts, mesh=mesh, bearings=springs)


def rough(train: DriveTrain, rng: np.random.Generator) -> DriveTrain:
    """The same with rings and rolling elements, with clearance or preload, in seats of a casing."""

    def law() -> RingLaw | ElementLaw | LinearLaw:
        kind = rng.integers(3)
        if kind == 0:
            return RingLaw(
                coefficient=10 ** rng.uniform(8, 11), exponent=1.5, clearance=rng.uniform(0, 3e-5)
            )
        if kind == 1:
            return own(10 ** rng.uniform(7.5, 9))
        return ElementLaw(
            elements=int(rng.integers(6, 14)),
            coefficient=10 ** rng.uniform(9, 10.3),
            exponent=float(rng.choice([1.5, 10 / 9])),
            clearance=rng.uniform(-5e-6, 2e-5),
        )

    seat = Seat(mass=0.2, stiffness=(3e8, 5e8), damping=300.0)
    bearings = tuple(
        replace(one, law=law(), seat=seat if rng.integers(2) else None) for one in train.bearings
    )
    casing = Casing(mass=40.0, stiffness=(5e7, 8e7), damping=2e3)
    return replace(train, bearings=bearings, casing=casing if rng.integers(2) else None)


@pytest.mark.parametrize("stiff", [1e13, 1e15])
def test_stiff_bearings_give_the_one_mass_frequency(compared: Compared, stiff: float) -> None:
    base = six(TRUTH["S1"]["params"])
    p = TRUTH["S1"]["params"]
    law = own(stiff)
    bearings = tuple(Bearing(name=s, shaft=s, position=0.0, law=law) for s in SHAFTS)
    parts = lumped(
        base.frame,
        masses=(p["m1"], p["m2"]),
        inertias=(p["I1"], p["I2"]),
        bearings=(bearings[0], bearings[1]),
    )
    train = LinearTrain(
        assembly=parts, mesh=p["k_mean"], bearings=np.array([stiff * np.eye(2)] * 2)
    )
    one_mass = np.sqrt(p["k_mean"] / parts.mesh_mass)
    away = train.modes(0.0).frequency.min() / one_mass - 1.0
    compared(f"natural frequency in bearings of {stiff:.0e} N/m", "sqrt(k/m_e)", away, 1e9 / stiff)


def test_frequencies_do_not_depend_on_the_frame(compared: Compared) -> None:
    """With isotropic bearings neither the centre line nor the pressure angle matters at rest."""
    worst = 0.0
    for train in trains(11):
        same = isotropic(train)
        known = linear(same).modes(200.0, count=10).frequency
        for phi in (0.3, 2.0, -1.1):
            turned = replace(same, frame=replace(same.frame, centre_line=phi))
            worst = max(
                worst, np.abs(linear(turned).modes(200.0, count=10).frequency / known - 1.0).max()
            )
        mirrored = replace(same, frame=replace(same.frame, sense=-same.frame.sense))
        found = linear(mirrored).modes(200.0, count=10).frequency
        worst = max(worst, np.abs(found / known - 1.0).max())
    compared("natural frequencies of a turned or mirrored frame", "the same frame", worst, 1e-9)


def test_statics_turn_with_the_frame(compared: Compared) -> None:
    worst = 0.0
    for train in trains(12):
        same = isotropic(train)
        phi = same.frame.centre_line
        turned = replace(same, frame=replace(same.frame, centre_line=phi + 0.7))
        first, second = (
            equilibrium(assemble(t), 80.0, mesh=3e8, half_backlash=5e-5) for t in (same, turned)
        )
        c, s = np.cos(0.7), np.sin(0.7)
        expected = first.bearing_force @ np.array([[c, s], [-s, c]])
        size = np.abs(expected).max()
        worst = max(worst, np.abs(second.bearing_force - expected).max() / size)
    compared("bearing loads of a turned frame", "the turned loads", worst, 1e-9)


def test_loads_of_the_bearings_balance_mesh_and_weight(compared: Compared) -> None:
    """Sums of force and of moment over each shaft, with every kind of bearing."""
    rng = np.random.default_rng(13)
    worst = 0.0
    for train in trains(14, gravity=9.81):
        made = rough(train, rng)
        parts = assemble(made)
        torque = 10 ** rng.uniform(0.0, 3.0)
        found = equilibrium(parts, torque, mesh=4e8, half_backlash=3e-5)
        force = torque / made.frame.base_radii[0]
        assert found.mesh_force == pytest.approx(force, rel=1e-8)
        pull = {"pinion": -force * made.frame.normals[0], "wheel": force * made.frame.normals[0]}
        for shaft in SHAFTS:
            drawn = made.shafts[SHAFTS.index(shaft)]
            mine = [i for i, b in enumerate(made.bearings) if b.shaft == shaft]
            loads = found.bearing_force[mine]
            nodes = range(parts.nodes[SHAFTS.index(shaft)].size)
            rows = [parts.index[f"{shaft}.{i}.y"] for i in nodes]
            weight = np.array([0.0, parts.weight[rows].sum()])
            lever = np.array([made.bearings[i].position for i in mine]) - drawn.gear_position
            weights = parts.weight[rows] @ (parts.nodes[SHAFTS.index(shaft)] - drawn.gear_position)
            turned = sum(
                (
                    parts.weight[parts.index[f"{shaft}.{i}.tx"]] * np.array([0.0, -1.0])
                    for i in nodes
                ),
                np.zeros(2),
            )
            worst = max(worst, np.abs(loads.sum(axis=0) - pull[shaft] - weight).max() / force)
            moment = lever @ loads - [0.0, weights] - turned
            worst = max(worst, np.abs(moment).max() / (force * drawn.length))
    compared("sum of forces and moments on a shaft", "0", worst, 1e-8)


def test_a_gear_between_two_bearings_loads_them_by_sine_and_cosine(compared: Compared) -> None:
    """F sin alpha' along the centres, F cos alpha' across, shared by the lever arms."""
    worst = 0.0
    for train in trains(15):
        same = isotropic(train)
        force = 150.0 / same.frame.base_radii[0]
        found = equilibrium(assemble(same), 150.0, mesh=3e8, half_backlash=2e-5)
        frame = same.frame
        alpha = frame.pressure_angle
        out, side = force * np.sin(alpha), force * frame.sense * np.cos(alpha)
        for sign, shaft, drawn in zip((-1.0, 1.0), SHAFTS, same.shafts, strict=True):
            mine = [i for i, b in enumerate(same.bearings) if b.shaft == shaft]
            z = np.array([same.bearings[i].position for i in mine])
            share = np.array([z[1] - drawn.gear_position, drawn.gear_position - z[0]]) / np.ptp(z)
            expected = sign * np.outer(share, out * frame.along + side * frame.across)
            worst = max(worst, np.abs(found.bearing_force[mine] - expected).max() / force)
    compared("static bearing loads", "F sin and F cos by lever arm", worst, 1e-8)


def test_everything_scales_with_load_backlash_and_clearance(compared: Compared) -> None:
    """Linear rings: torque, backlash and clearance times c give c times the displacement."""
    rng = np.random.default_rng(16)
    worst = 0.0
    for train in trains(17):
        c = 10 ** rng.uniform(-1.0, 1.0)
        bearings = [
            tuple(
                replace(one, law=RingLaw(coefficient=2e8, clearance=factor * 8e-6))
                for one in train.bearings
            )
            for factor in (1.0, c)
        ]
        first, second = (
            equilibrium(
                assemble(replace(train, bearings=some)),
                factor * 60.0,
                mesh=3e8,
                half_backlash=factor * 4e-5,
            )
            for some, factor in zip(bearings, (1.0, c), strict=True)
        )
        size = np.abs(second.displacement).max()
        worst = max(worst, np.abs(second.displacement - c * first.displacement).max() / size)
    compared("displacement under c times everything", "c times the displacement", worst, 1e-8)


def test_the_equilibrium_is_the_minimum_of_its_potential() -> None:
    """Pushed anywhere, the residual works against the push."""
    rng = np.random.default_rng(18)
    for train in trains(19, gravity=9.81):
        made = rough(train, rng)
        parts = assemble(made)
        far = 1e-5 * rng.standard_normal(parts.size)
        first = equilibrium(parts, 40.0, mesh=3e8, half_backlash=3e-5)
        second = equilibrium(parts, 40.0, mesh=3e8, half_backlash=3e-5, start=far)
        size = np.abs(first.bearing_force).max()
        assert second.bearing_force == pytest.approx(first.bearing_force, abs=1e-6 * size)


def test_critical_speeds_are_crossings_of_the_modes(compared: Compared) -> None:
    """One eigenproblem an order finds what a sweep over speed would."""
    worst = 0.0
    for train in trains(20):
        made = linear(train)
        for order in (1.0, float(train.frame.teeth[0])):
            speeds, _ = made.critical(order)
            for speed in speeds[:3]:
                near = np.abs(made.modes(float(speed)).frequency - order * speed).min()
                worst = max(worst, near / (order * speed))
    compared("critical speeds", "natural frequencies at those speeds", worst, 1e-9)


def test_energy_shares_sum_to_one_and_modes_stay_orthogonal() -> None:
    for train in trains(21):
        made = linear(train)
        modes = made.modes(300.0, count=8)
        total = sum(strain_shares(made, modes.shape).values())
        assert total == pytest.approx(np.ones(8), rel=1e-9)
        w, q = modes.frequency, modes.shape
        both = np.outer(w, w) * (q.conj().T @ made.assembly.mass @ q)
        both = both + q.conj().T @ made.stiffness @ q
        assert both == pytest.approx(np.eye(8), abs=1e-8)


def test_damped_modes_tend_to_the_undamped(compared: Compared) -> None:
    worst = 0.0
    for train in trains(22):
        slight = replace(isotropic(train), damping=Damping(shafts=1e-12, mesh=1e-9))
        slight = replace(
            slight, bearings=tuple(replace(one, damping=1e-4) for one in slight.bearings)
        )
        made = linear(slight)
        free, damped = made.modes(250.0), made.modes(250.0, damped=True)
        worst = max(worst, np.abs(damped.frequency[:10] / free.frequency[:10] - 1.0).max())
        assert np.all(damped.damping_ratio > 0.0)
    compared("modes with vanishing damping", "undamped modes", worst, 1e-7)


@pytest.mark.parametrize("kind", ["modal", "proportional", "bearings"])
def test_each_kind_of_damping_leaves_the_rotation_free(kind: str) -> None:
    for train in trains(23)[:4]:
        chosen = Damping(kind=kind, ratio=0.02, mass=20.0, shafts=1e-6)
        made = linear(replace(isotropic(train), damping=chosen))
        r = made.assembly.rotation
        assert made.damping @ r == pytest.approx(
            np.zeros(r.size), abs=1e-9 * np.abs(made.damping).max()
        )
        assert np.linalg.eigvalsh(made.damping).min() > -1e-9 * np.abs(made.damping).max()
        if kind == "modal":
            assert made.modes(0.0, damped=True).damping_ratio == pytest.approx(0.02, rel=1e-6)


def test_power_of_the_error_is_what_the_damping_takes(compared: Compared) -> None:
    """Mean power of the force on the flank = q'^H C q'/2."""
    worst = 0.0
    for train in trains(24):
        made = linear(isotropic(train))
        speeds = np.array([100.0, 220.0, 400.0])
        order, error = float(train.frame.teeth[0]), 3e-6 * np.exp(0.4j)
        found = error_response(made, speeds, order=order, error=error)
        w = found.frequency
        push = (made.mesh + 1j * w * made.mesh_damping) * error
        rate = 1j * w[:, None] * found.displacement
        power = 0.5 * np.real(push * (rate @ made.assembly.drive).conj())
        lost = 0.5 * np.einsum("si,ij,sj->s", rate.conj(), made.damping, rate).real
        worst = max(worst, np.abs(power / lost - 1.0).max())
    compared("power of the transmission error", "power of the damping", worst, 1e-8)


def test_bearing_forces_of_the_response_accelerate_the_shafts(compared: Compared) -> None:
    """Momentum: the sum over a shaft's bearings and its mesh force is m a."""
    worst = 0.0
    for train in trains(25):
        made = linear(replace(isotropic(train), damping=Damping(shafts=0.0)))
        order, error = float(train.frame.teeth[0]), 2e-6
        found = error_response(made, [150.0], order=order, error=error)
        for sign, shaft in zip((1.0, -1.0), SHAFTS, strict=True):
            mine = [i for i, b in enumerate(train.bearings) if b.shaft == shaft]
            parts = made.assembly
            nodes = range(parts.nodes[SHAFTS.index(shaft)].size)
            rows = [[parts.index[f"{shaft}.{i}.{c}"] for i in nodes] for c in ("x", "y")]
            moved = (parts.mass @ found.displacement[0])[rows].sum(axis=1)
            pull = -(found.frequency[0] ** 2) * moved
            force = -found.bearing_force[0, mine].sum(axis=0)
            force = force - sign * found.mesh_force[0] * train.frame.normals[0]
            worst = max(worst, np.abs(force - pull).max() / np.abs(found.mesh_force).max())
    compared("momentum of a vibrating shaft", "forces of bearings and mesh", worst, 1e-8)


def test_unbalance_whirls_forward_and_its_bearings_carry_it(compared: Compared) -> None:
    """Far below resonance the bearings of a shaft carry m e_c W^2, turning with the shaft."""
    worst = 0.0
    for train in trains(26):
        for shaft, drawn in zip(SHAFTS, train.shafts, strict=True):
            load = Unbalance(shaft=shaft, position=drawn.gear_position, moment=1e-4, angle=0.6)
            made = linear(isotropic(replace(train, unbalances=(load,))))
            found = unbalance_response(made, [0.5], shaft, (load,))
            mine = [i for i, b in enumerate(train.bearings) if b.shaft == shaft]
            total = found.bearing_force[0, mine].sum(axis=0)
            size = load.moment * found.frequency[0] ** 2
            worst = max(worst, abs(np.abs(total).max() / size - 1.0))
            sense = whirl(made.assembly, found.displacement.T)[shaft]
            assert sense[0] == pytest.approx(1.0, abs=1e-3)
    compared("bearing force of a slow unbalance", "m e W^2", worst, 1e-4)


def test_run_out_equals_a_gear_whose_centre_is_moved() -> None:
    """A slow run-out moves the static error as the flanks of a shifted gear do."""
    (train,) = trains(27)[:1]
    parts = assemble(train)
    for shaft, sign in zip(SHAFTS, (1.0, -1.0), strict=True):
        turns = sign * train.frame.sense
        error = run_out_error(parts, RunOut(shaft=shaft, eccentricity=1e-5, angle=0.9))
        for angle in (0.0, 1.0, 4.0):
            centre = 1e-5 * np.array([np.cos(0.9 + turns * angle), np.sin(0.9 + turns * angle)])
            pushed = -train.frame.normals[0] @ centre * sign
            assert float(np.real(error * np.exp(1j * angle))) == pytest.approx(pushed, abs=1e-15)


def test_loaded_error_is_the_change_of_the_static_deflection(compared: Compared) -> None:
    phase = np.arange(256) / 256
    k = 3e8 + 2e5 * np.cos(2 * np.pi * phase) + 1e5 * np.sin(4 * np.pi * phase)
    found = loaded_error([2e5, -1e5j], [1e-6], mean_stiffness=3e8, mean_force=2000.0)
    moved = 2000.0 / k + 1e-6 * np.cos(2 * np.pi * phase)
    lines = 2.0 * np.fft.rfft(moved)[1:3] / phase.size
    compared("loaded error of a slight ripple", "F/k(t) + e", np.abs(found - lines) / 1e-6, 1e-5)


def test_a_shaft_that_nothing_holds_is_refused() -> None:
    (train,) = trains(28)[:1]
    loose = replace(train, bearings=train.bearings[:1] + train.bearings[2:])
    with pytest.raises(InputError, match="free motion"):
        linear(loose).modes(0.0)
    with pytest.raises(InputError, match="free motion"):
        equilibrium(assemble(loose), 10.0, mesh=3e8, half_backlash=1e-5)


def test_a_stiffness_that_is_no_number_ends_and_does_not_hang() -> None:
    (train,) = trains(36)[:1]
    parts = assemble(train)
    with pytest.raises((ConvergenceError, InputError, ValueError)):
        equilibrium(parts, 10.0, mesh=float("nan"), half_backlash=1e-5)
    with pytest.raises(ConvergenceError, match="no number"):
        equilibrium(parts, 10.0, mesh=3e8, half_backlash=float("nan"))


def test_places_off_the_shaft_are_refused() -> None:
    (train,) = trains(29)[:1]
    far = replace(train.bearings[0], position=10.0)
    with pytest.raises(InputError, match="position"):
        assemble(replace(train, bearings=(far, *train.bearings[1:])))
    assert isinstance(assemble(train), Assembly)


def test_a_motor_that_gives_way_damps_its_own_mode(compared: Compared) -> None:
    """The peak of a slow mode falls as its ratio says; a lag takes the damper away above 1/T."""
    (train,) = trains(30)[:1]
    assert train.motor is not None
    soft = replace(isotropic(train), motor=replace(train.motor, stiffness=2e3, inertia=0.05))

    def slowest(slip: float, lag: float) -> tuple[float, float]:
        assert soft.motor is not None
        made = linear(replace(soft, motor=replace(soft.motor, slip_damping=slip, lag=lag)))
        modes = made.modes(0.0, count=2)
        return float(damping_ratios(made, modes.shape, frequency=modes.frequency)[0]), float(
            modes.frequency[0]
        )

    bare, frequency = slowest(0.0, 0.0)
    damped, _ = slowest(0.5, 0.0)
    late, _ = slowest(0.5, 10.0 / frequency)
    assert damped > bare
    compared(
        "damper behind a lag", "1/(1 + (w T)^2)", (late - bare) / (damped - bare) * 101 - 1, 1e-6
    )
    peaks = []
    for slip in (0.2, 0.5):
        assert soft.motor is not None
        made = linear(replace(soft, motor=replace(soft.motor, slip_damping=slip)))
        found = error_response(made, [frequency], order=1.0, error=1e-6)
        ratio = slowest(slip, 0.0)[0]
        peaks.append(np.abs(found.displacement[0, made.assembly.index["motor.tz"]]) * ratio)
    compared("height of the motor's resonance", "one over its ratio", peaks[0] / peaks[1] - 1, 0.02)


def test_statics_of_two_masses_as_truth_s1(compared: Compared) -> None:
    case = TRUTH["S1"]
    p, values = case["params"], case["values"]
    parts = six(p)
    found = equilibrium(parts, p["T1"], mesh=p["k_mean"], half_backlash=p["b"])
    twist = np.array([parts.at_gear(s)[:, 4] @ found.displacement for s in SHAFTS])
    away = [
        found.mesh_force / values["mesh_force"] - 1.0,
        *(np.linalg.norm(found.bearing_force, axis=1) / values["bearing_force"] - 1.0),
        *(found.centre("pinion") / values["pinion"] - 1.0),
        *(found.centre("wheel") / values["wheel"] - 1.0),
        found.drive / values["delta"] - 1.0,
        parts.frame.base_radii @ twist / values["twist_p"] - 1.0,
        found.centre_distance_growth / values["centre_distance_growth"] - 1.0,
        np.sin(parts.frame.pressure_angle) * found.centre_distance_growth
        / values["backlash_growth_one_flank"] - 1.0,
    ]  # fmt: skip
    compared("two masses in clearance", "closed form; Newton", away, 1e-9)


def test_three_bearings_share_by_stiffness(compared: Compared) -> None:
    """Clapeyron's three moments: a slender shaft on three stiff bearings, the load in one span."""
    rng = np.random.default_rng(31)
    worst = 0.0
    for train in trains(32):
        spans = rng.uniform(0.8, 2.0, 2)
        at = float(rng.uniform(0.2, 0.8) * spans[0])
        made = train.shafts[0].sections[0].material
        thin = Section(length=float(spans.sum()), outer_diameter=0.02, material=made)
        shaft = Shaft(sections=(thin,), gear_position=at)
        places = [0.0, float(spans[0]), float(spans.sum())]
        mine = tuple(
            Bearing(name=f"p{n}", shaft="pinion", position=z, law=own(1e13))
            for n, z in enumerate(places)
        )
        others = tuple(b for b in train.bearings if b.shaft == "wheel")
        whole = replace(
            train, shafts=(shaft, train.shafts[1]), bearings=mine + others, motor=None,
            least_elements=24,
        )  # fmt: skip
        found = equilibrium(assemble(whole), 0.05, mesh=3e8, half_backlash=0.0)
        force = 0.05 / whole.frame.base_radii[0]
        moment = -force * at * (spans[0] ** 2 - at**2) / spans[0] / (2.0 * spans.sum())
        left = force * (spans[0] - at) / spans[0] + moment / spans[0]
        right = moment / spans[1]
        expected = np.array([left, force - left - right, right])
        loads = found.bearing_force[:3] @ -whole.frame.normals[0]
        worst = max(worst, np.abs(loads - expected).max() / force)
    compared("three bearings on a slender shaft", "three moments", worst, 1e-3)


def test_an_overhung_gear_lifts_the_far_bearing() -> None:
    (train,) = trains(33)[:1]
    shaft = replace(train.shafts[0], gear_position=0.0)
    mine = [
        replace(b, position=z * shaft.length)
        for b, z in zip(train.bearings[:2], (0.4, 0.9), strict=True)
    ]
    whole = isotropic(
        replace(train, shafts=(shaft, train.shafts[1]), bearings=(*mine, *train.bearings[2:]))
    )
    found = equilibrium(assemble(whole), 50.0, mesh=3e8, half_backlash=1e-5)
    loads = found.bearing_force[:2] @ -whole.frame.normals[0] * whole.frame.base_radii[0] / 50.0
    assert loads == pytest.approx([0.9 / 0.5, -0.4 / 0.5], rel=1e-8)


def test_the_gears_tilt_as_a_simply_supported_shaft_does(compared: Compared) -> None:
    """Slope under the load F a b (b - a)/(3 E I L) of a slender shaft against a rigid one."""
    rng = np.random.default_rng(34)
    worst = 0.0
    for train in trains(35):
        span, share = float(rng.uniform(1.0, 2.0)), float(rng.uniform(0.2, 0.8))
        made = train.shafts[0].sections[0].material
        thin = Section(length=span, outer_diameter=0.015, material=made)
        thick = Section(length=span, outer_diameter=0.6, material=made)
        drawn = tuple(Shaft(sections=(s,), gear_position=share * span) for s in (thin, thick))
        bearings = tuple(
            Bearing(name=f"{name} {z}", shaft=name, position=z * span, law=own(1e14))
            for name in SHAFTS
            for z in (0.0, 1.0)
        )
        whole = replace(
            train, shafts=(drawn[0], drawn[1]), bearings=bearings, motor=None, load=None
        )
        found = equilibrium(assemble(whole), 0.05, mesh=3e8, half_backlash=0.0)
        force = 0.05 / whole.frame.base_radii[0]
        stiff = made.youngs_modulus * np.pi / 64.0 * 0.015**4
        a, b = share * span, (1.0 - share) * span
        slope = -force * a * b * (b - a) / (3.0 * stiff * span)
        worst = max(worst, abs(found.misalignment - slope) / abs(force * span**2 / stiff))
    compared("tilt of a gear on a slender shaft", "F a b (b - a)/(3 E I L)", worst, 1e-4)


def test_a_resonance_lifts_off_where_its_own_curve_meets_the_load() -> None:
    """On the curve of one mode; beside a light damping at 1 - zeta sqrt(e^2 - 1) of its speed."""
    rng = np.random.default_rng(20261127)
    zeta, excess = rng.uniform(1e-4, 0.1, 200), np.exp(rng.uniform(0.0, 1.5, 200))
    r = lift_off(300.0, ratio=zeta, excess=excess) / 300.0
    curve = 2.0 * zeta / np.hypot(1.0 - r**2, 2.0 * zeta * r)
    assert np.abs(curve * excess - 1.0).max() < 1e-8
    assert np.all(r <= 1.0)
    light = lift_off(1.0, ratio=1e-6, excess=3.0)
    assert (1.0 - light) / 1e-6 == pytest.approx(np.sqrt(8.0), rel=1e-4)
    # at rest it is above the load already; and it never is
    assert lift_off(300.0, ratio=0.1, excess=20.0) == 0.0
    assert np.isnan(lift_off(300.0, ratio=0.1, excess=0.9))
    # an unbalance pushes with the speed squared: none at rest, however light the load
    r = lift_off(300.0, ratio=zeta, excess=10.0 * excess, unbalance=True) / 300.0
    curve = 2.0 * zeta * r**2 / np.hypot(1.0 - r**2, 2.0 * zeta * r)
    assert np.abs(curve * 10.0 * excess - 1.0).max() < 1e-8
    assert np.all((r > 0.0) & (r <= 1.0))
