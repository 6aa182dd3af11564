"""K_v of ISO 6336-1 against worked examples, its branches, exchange, ranges."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS
from thermogear.base.units import RPM
from thermogear.gears.accuracy import flank_tolerances
from thermogear.gears.dynamic_factor import (
    BRANCHES,
    branch_factors,
    dynamic_factor,
    factor_of_resonance,
    reduced_mass,
    resonance_edge,
    resonance_speed,
    running_in,
    running_in_relief,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.iso6336 import iso6336_stiffness
from thermogear.gears.pair import GearPair

STEEL = replace(MATERIALS["steel"], density=7830.0)
PAIR = GearPair(
    Gear(25, 3e-3, face_width=30e-3, bore_radius=15e-3, material=STEEL),
    Gear(75, 3e-3, face_width=30e-3, bore_radius=30e-3, material=STEEL),
)


def fzg_c(tips: tuple[float, float] = (82.46, 118.36), bore: float = 15e-3) -> GearPair:
    gears = [
        Gear(
            teeth,
            4.5e-3,
            profile_shift=shift,
            tip_radius=0.5e-3 * tip,
            face_width=14e-3,
            bore_radius=bore,
            material=STEEL,
        )
        for teeth, shift, tip in zip((16, 24), (0.1817, 0.1715), tips, strict=True)
    ]
    return GearPair(*gears)


def test_the_pair_of_the_collection(compared: Compared) -> None:
    """25/75 m 3 b 30, bores 30/60, A6, 200 N m: all figures in between, then K_v."""
    rpm = np.array([3000.0, 9000.0, 13638.0, 1.3 * 13638.0, 1.5 * 13638.1, 3.0 * 13638.0])
    got = dynamic_factor(PAIR, 200.0, rpm * RPM, grade=6)
    stiffness = iso6336_stiffness(PAIR, got.line_load[0])
    limits = flank_tolerances(75, 3e-3, grade=6)
    figures = {
        177.8: got.line_load[0] * 1e-3,
        1.0 / 17.578: 1e9 / float(stiffness.theoretical),
        13.711: stiffness.single * 1e-9,
        21.057: stiffness.mesh * 1e-9,
        0.016518: reduced_mass(PAIR) * 1e-3,
        13638.0: got.resonance[0] / RPM,
        8.538: 1e6 * limits.single_pitch * math.cos(math.radians(20.0)),
        9.405: 1e6 * limits.profile_form,
        0.6091: got.pitch[0],
        0.6709: got.form[0],
        1.0: got.relief[0],
        0.7773: branch_factors(PAIR.contact_ratio)[6],
        0.220: got.ratio[0],
        0.660: got.ratio[1],
    }
    for given, found in figures.items():
        assert float(found) == pytest.approx(given, rel=2e-4)
    factors = np.array([1.144, 1.431, 2.323, 1.918, 1.379, 1.379])
    compared("K_v of the reference pair", "computed apart", got.factor - factors, 6e-4)
    assert np.asarray(got.branch).tolist() == [0, 0, 1, 2, 3, 3]  # places in BRANCHES


def test_two_discs_have_nearly_the_reduced_mass() -> None:
    """The source scales the pinion up; two true discs: 0.016561 kg/mm."""
    inertia = []
    for gear in (PAIR.pinion, PAIR.wheel):
        mean = 0.5 * (gear.tip_radius + gear.root_radius)
        inertia.append(
            0.5 * math.pi * 7830.0 * (mean**4 - gear.bore_radius**4) / gear.base_radius**2
        )
    discs = inertia[0] * inertia[1] / sum(inertia)
    assert 1e-3 * discs == pytest.approx(0.016561, abs=1e-6)
    assert reduced_mass(PAIR) == pytest.approx(discs, rel=3e-3)


def test_fzg_c() -> None:
    """200 N m, 1500 min-1, A5: K_v 1.025 without relief; with that of running in 0.001 less."""
    plain = dynamic_factor(fzg_c(), 200.0, 1500.0 * RPM, grade=5, tip_relief=0.0)
    assert float(plain.resonance) / RPM == pytest.approx(21574.0, abs=1.0)
    assert float(plain.factor) == pytest.approx(1.025, abs=6e-4)
    eased = dynamic_factor(fzg_c(), 200.0, 1500.0 * RPM, grade=5)
    assert 0.0 < float(plain.factor - eased.factor) < 2e-3


def test_fzg_c_of_a_public_code() -> None:
    """GEARpie's C14, K_A 1.25, solid, tips uncut: printed 1.02, 1.0235 computed apart."""
    pair = fzg_c((82.64, 118.54), bore=0.01e-3)
    got = dynamic_factor(pair, 200.0, 1500.0 * RPM, grade=5, application=1.25, tip_relief=0.0)
    assert float(got.factor) == pytest.approx(1.0235, abs=6e-5)


@pytest.mark.parametrize("edition", ["2013", "1995"])
@pytest.mark.parametrize("bore", [0.0, 0.5])
def test_worked_example_of_the_technical_report(edition: str, bore: float) -> None:
    """ISO/TR 6336-30 example 1, helical: 17/103, m 8, 15.8 deg; K_v 1.0028..1.0032, N 0.04."""
    alpha, beta, m = math.radians(20.0), math.radians(15.8), 8.0
    transverse = math.atan(math.tan(alpha) / math.cos(beta))
    d = [m * z / math.cos(beta) for z in (17, 103)]
    base = [one * math.cos(transverse) for one in d]
    tip = [one + 2.0 * m * (1.0 + x) for one, x in zip(d, (0.145, 0.0), strict=True)]
    root = [one - 2.0 * m * (1.4 - x) for one, x in zip(d, (0.145, 0.0), strict=True)]
    working = math.acos(0.5 * sum(base) / 500.0)
    path = sum(0.5 * math.sqrt(t**2 - b**2) for t, b in zip(tip, base, strict=True))
    path -= 500.0 * math.sin(working)
    e_alpha = path / (math.pi * m / math.cos(beta) * math.cos(transverse))
    e_gamma = e_alpha + 100.0 * math.sin(beta) / (math.pi * m)
    load, single = 2.0 * 9e6 / d[0] / 100.0, 12.37047
    mesh = single * (0.75 * e_alpha + 0.25)
    mean = [0.5 * (t + r) for t, r in zip(tip, root, strict=True)]
    solid = 7.83e-6 * (1.0 - bore**4)
    mass = math.pi / 8.0 * (mean[0] / base[0]) ** 2 * mean[0] ** 2
    mass /= (1.0 + (17 / 103) ** 2) / solid
    resonance = float(resonance_speed(mesh * 1e9, mass * 1e3, teeth=17)) / RPM
    # the reference circles of the helical gears stand for their sizes
    pitch, form = (
        1e6 * max(getattr(flank_tolerances(z, m * 1e-3 / math.cos(beta), grade=5, edition=edition),
                          name) for z in (17, 103))
        for name in ("single_pitch", "profile_form")
    )  # fmt: skip
    found, branch = factor_of_resonance(
        360.0 / resonance,
        pitch=single * (pitch * math.cos(transverse) * 0.925) / load,
        form=single * form * 0.925 / load,
        relief=abs(1.0 - single * 70.0 / load),
        contact_ratio=e_gamma,
    )
    assert BRANCHES[int(branch)] == "subcritical"
    assert 360.0 / resonance == pytest.approx(0.04, abs=5e-3)
    assert float(found) == pytest.approx(1.003, abs=2.5e-4)


def test_the_branches_meet() -> None:
    given = {"pitch": 0.6, "form": 0.7, "relief": 1.0}
    for ratio in (1.2, 1.5, 1.71, 2.0, 2.2, 2.5, 3.1):
        at = np.array([0.0, 1.15, 1.15 + 1e-12, 1.5 - 1e-12, 1.5, 40.0])
        found, _ = factor_of_resonance(at, **given, contact_ratio=ratio)
        assert found[0] == 1.0
        assert found[1] == pytest.approx(found[2], abs=1e-10)
        assert found[3] == pytest.approx(found[4], abs=1e-10)
        assert found[4] == found[5]
    # the source steps where the contact ratio passes 2: by 9 % at most in any factor
    steps = [b / a for a, b in zip(branch_factors(2.0), branch_factors(2.0 + 1e-9), strict=True)]
    assert max(abs(step - 1.0) for step in steps) < 0.09
    for edge in (1.5, 2.5):
        assert branch_factors(edge)[6] == pytest.approx(branch_factors(edge + 1e-9)[6], abs=1e-8)
    assert resonance_edge(np.array([0.0, 25e3, 100e3, 1e6])) == pytest.approx(
        [0.5, 0.675, 0.85, 0.85]
    )


def test_exchange_scale_and_grade() -> None:
    """The wheel driving, or all sizes times k at the same pitch speed: same mesh, same K_v."""
    rng = np.random.default_rng(6336)
    for _ in range(30):
        z1, z2 = sorted(int(z) for z in rng.integers(19, 80, 2))
        m, torque = float(rng.uniform(1.5e-3, 6e-3)), float(rng.uniform(50.0, 900.0))
        pair = GearPair(Gear(z1, m, profile_shift=0.1), Gear(z2, m))
        speed = float(rng.uniform(50.0, 900.0))
        grade = int(rng.integers(4, 9))
        here = dynamic_factor(pair, torque, speed, grade=grade)
        there = dynamic_factor(pair.swapped(), torque * pair.ratio, speed / pair.ratio, grade=grade)
        assert float(here.factor) == pytest.approx(float(there.factor), rel=1e-12)
        coarse = dynamic_factor(pair, torque, speed, grade=max(grade, 6) + 1)
        fine = dynamic_factor(pair, torque, speed, grade=max(grade, 6))
        assert float(coarse.factor) >= float(fine.factor) >= 1.0
        large = GearPair(Gear(z1, 2 * m, profile_shift=0.1), Gear(z2, 2 * m))
        assert reduced_mass(large) == pytest.approx(4.0 * reduced_mass(pair), rel=1e-12)
        many = dynamic_factor(pair, np.array([[torque], [2 * torque]]), [speed, 0.0], grade=grade)
        assert many.factor.shape == (2, 2)
        assert many.factor[0, 0] == float(here.factor)
        assert np.array_equal(many.factor[:, 1], [1.0, 1.0])


def test_running_in_and_blanks() -> None:
    kept = {"endurance": 1500e6, "surface": "case-hardened"}
    assert float(running_in(8.538e-6, pitch_speed=12.0, **kept)) == pytest.approx(
        0.640e-6, abs=1e-9
    )
    assert float(running_in(100e-6, pitch_speed=12.0, **kept)) == 3e-6
    soft = {"endurance": 640e6, "surface": "through-hardened"}
    v = np.array([4.0, 8.0, 12.0])
    assert running_in(100e-6, pitch_speed=v, **soft) == pytest.approx([25e-6, 20e-6, 10e-6])
    # 2.0 um for the usual case-hardened steel
    assert running_in_relief(1500e6) == pytest.approx(2.0e-6, abs=0.01e-6)
    thin = iso6336_stiffness(PAIR, blank=0.9)
    assert float(thin.single) == pytest.approx(0.9 * float(iso6336_stiffness(PAIR).single))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: dynamic_factor(PAIR, 0.0, 100.0, grade=6),
            "torque: got 0.0 N m; allowed > 0, finite",
        ),
        (
            lambda: dynamic_factor(PAIR, 10.0, -1.0, grade=6),
            "speed: got -1.0 rad/s; allowed >= 0, finite",
        ),
        (
            lambda: dynamic_factor(PAIR, 10.0, 100.0, grade=12),
            "accuracy.grade: got 12; allowed a whole number, 1..11; the grades of ISO 1328-1:2013",
        ),
        (
            lambda: dynamic_factor(PAIR, 10.0, 100.0, grade=6, surface="nitrided"),
            "surface: got 'nitrided'; allowed case-hardened | through-hardened; "
            "known: case-hardened, through-hardened",
        ),
        (lambda: branch_factors(0.9), "contact ratio: got 0.9; allowed >= 1"),
    ],
)
def test_outside_the_ranges(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value) == message
