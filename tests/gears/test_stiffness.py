"""The textbook mesh stiffness: published elements, the thesis's curve, limits and symmetries."""

from __future__ import annotations

import numpy as np
import pytest

from conftest import Compared
from finite_elements import pair_stiffness as finite_stiffness
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.sharing import equal_share, stiffness_share
from thermogear.gears.stiffness import (
    Moduli,
    mesh_figures,
    mesh_stiffness,
    pair_compliances,
    pair_stiffness,
    sainsot_compliance,
    yang_sun_stiffness,
)


def rig(face_width: float, bores: tuple[float, float]) -> GearPair:
    return GearPair(
        Gear(25, 5e-3, face_width=face_width, bore_radius=bores[0]),
        Gear(75, 5e-3, face_width=face_width, bore_radius=bores[1]),
    )


REFERENCE = rig(20e-3, (20e-3, 60e-3))
THESIS = rig(23.54e-3, (30e-3, 100e-3))


@pytest.mark.parametrize(
    ("start", "pinion", "wheel"),
    [
        ("root-circle", (7.48417e9, 2.02541e9, 7.29525e10), (1.20947e10, 2.26467e9, 6.09691e10)),
        ("30-degree", (1.22516e10, 2.38209e9, 8.57997e10), (1.93890e10, 2.61821e9, 7.04870e10)),
    ],
)
def test_elements_at_the_pitch_point(
    start: str, pinion: tuple[float, ...], wheel: tuple[float, ...], compared: Compared
) -> None:
    parts = pair_compliances(REFERENCE, REFERENCE.path.c, start)
    got = 1.0 / np.array([*parts.pinion.tooth, *parts.wheel.tooth], dtype=float)
    compared(
        "bending, shear and axial stiffness of both teeth",
        "computed apart, m 5, 25:75",
        got / (*pinion, *wheel) - 1.0,
        1e-4,
    )
    body = 1.0 / np.array([parts.pinion.foundation, parts.wheel.foundation], dtype=float)
    compared(
        "foundation by Sainsot's polynomial",
        "computed apart, m 5, 25:75",
        body / (8.67547e8, 7.79007e8) - 1.0,
        1e-4,
    )
    compared(
        "contact by Yang and Sun",
        "computed apart",
        1.0 / float(parts.contact) / 3.55587e9 - 1.0,
        1e-4,
    )


def test_contact_of_equal_materials() -> None:
    young, nu, width = 206e9, 0.3, 0.02
    got = yang_sun_stiffness(young / (2 * (1 - nu**2)), width)
    assert float(got) == pytest.approx(np.pi * young * width / (4 * (1 - nu**2)), rel=1e-14)


def test_the_curve_of_the_thesis(compared: Compared) -> None:
    figures = mesh_figures(THESIS)
    got = np.array([figures.minimum, figures.maximum, figures.mean])
    compared(
        "least, greatest and mean of the textbook sum",
        "computed apart",
        got / (3.494e8, 6.255e8, 5.41e8) - 1.0,
        5e-3,
    )
    middle = 0.5 * (figures.minimum + figures.maximum)
    compared(
        "middle of the textbook stiffness",
        "4.875e8 N/m, printed in the thesis",
        middle / 4.875e8 - 1.0,
        4e-3,
    )
    swing = figures.maximum - figures.minimum
    compared(
        "swing of the textbook stiffness",
        "2.75e8 N/m, printed in the thesis",
        swing / 2.75e8 - 1.0,
        5e-3,
    )


def test_figures_are_those_of_the_sampled_curve() -> None:
    phase = (np.arange(4000) + 0.5) / 4000
    curve = mesh_stiffness(THESIS, phase)
    figures = mesh_figures(THESIS)
    # two jumps fall into samples of 1/4000 period
    assert figures.mean == pytest.approx(curve.mean(), rel=2e-4)
    assert figures.minimum == pytest.approx(curve.min(), rel=1e-4)
    assert figures.maximum == pytest.approx(curve.max(), rel=1e-4)


def test_mesh_is_the_sum_of_the_pairs_in_contact() -> None:
    pair = REFERENCE
    assert float(mesh_stiffness(pair, 0.8)) == pytest.approx(
        float(pair_stiffness(pair, pair.path.a + 0.8 * pair.base_pitch)), rel=1e-15
    )
    both = pair_stiffness(pair, pair.path.a + np.array([0.3, 1.3]) * pair.base_pitch)
    assert float(mesh_stiffness(pair, 0.3)) == pytest.approx(both.sum(), rel=1e-15)
    assert np.array_equal(pair_stiffness(pair, [0.0, pair.line_of_action, np.nan]), np.zeros(3))


def test_swapped_gears_run_the_curve_backwards() -> None:
    pair = GearPair(Gear(26, 3e-3, profile_shift=0.3), Gear(45, 3e-3, bore_radius=20e-3))
    s = np.linspace(pair.path.a, pair.path.e, 15)
    mirrored = pair_stiffness(pair.swapped(), pair.line_of_action - s)
    with np.errstate(invalid="raise"):
        assert np.allclose(mirrored, pair_stiffness(pair, s), rtol=1e-9)


def test_stiffness_per_width_does_not_know_the_module() -> None:
    small = GearPair(Gear(25, 1e-3), Gear(75, 1e-3))
    large = GearPair(Gear(25, 8e-3), Gear(75, 8e-3))
    phase = np.linspace(0, 1, 20, endpoint=False)
    a = mesh_stiffness(small, phase) / small.face_width
    b = mesh_stiffness(large, phase) / large.face_width
    assert np.allclose(a, b, rtol=1e-9)


def test_the_smaller_face_width_counts() -> None:
    wide = GearPair(
        Gear(25, 5e-3, face_width=30e-3, bore_radius=20e-3),
        Gear(75, 5e-3, face_width=20e-3, bore_radius=60e-3),
    )
    assert np.array_equal(mesh_stiffness(wide, [0.1, 0.8]), mesh_stiffness(REFERENCE, [0.1, 0.8]))


def test_hot_moduli_scale_their_parts_and_broadcast() -> None:
    """E falls alike in everything: so does k. In the pinion's teeth alone: only its parts."""
    phase = np.linspace(0, 1, 6, endpoint=False)
    factor = np.array([[1.0], [0.95]])
    hot = Moduli(tooth=206e9 * factor, body=206e9 * factor)
    k = mesh_stiffness(REFERENCE, phase, pinion=hot, wheel=hot)
    assert k.shape == (2, 6)
    assert np.allclose(k[1], 0.95 * k[0], rtol=1e-13)
    share = stiffness_share(
        REFERENCE, REFERENCE.path.a + phase * REFERENCE.base_pitch, pinion=hot, wheel=hot
    )
    assert np.allclose(share[0], share[1], rtol=1e-13)

    cold = pair_compliances(REFERENCE, REFERENCE.path.c)
    warm = pair_compliances(REFERENCE, REFERENCE.path.c, pinion=Moduli(tooth=103e9, body=206e9))
    assert float(warm.pinion.tooth.total) == pytest.approx(2 * float(cold.pinion.tooth.total))
    assert float(warm.pinion.foundation) == float(cold.pinion.foundation)
    assert float(warm.contact) == pytest.approx(1.5 * float(cold.contact))
    assert float(warm.wheel.total) == float(cold.wheel.total)


def test_modulus_of_temperature() -> None:
    gear = REFERENCE.pinion
    cold = Moduli.at(gear, tooth=293.15, body=293.15)
    assert (float(cold.tooth), float(cold.body)) == (206e9, 206e9)
    hot = Moduli.at(gear, tooth=393.15, body=373.15)
    assert float(hot.tooth) == pytest.approx(206e9 * (1 - 3.3e-2))
    assert float(hot.body) == pytest.approx(206e9 * (1 - 2.64e-2))
    with pytest.raises(
        InputError, match=r"^modulus\.tooth: got -1 Pa \(-1e-09 GPa\); allowed 0\.01"
    ):
        Moduli(tooth=-1.0, body=206e9)


def test_foundation_warns_outside_its_source() -> None:
    thick = Gear(13, 5e-3, profile_shift=0.3)
    with pytest.warns(ValidityWarning, match=r"13 teeth: r_f/r_bore = .*theta_f = 0\.23"):
        sainsot_compliance(thick, 0.4)
    thin = Gear(75, 5e-3, bore_radius=150e-3)
    with pytest.warns(ValidityWarning, match=r"r_f/r_bore = 1\.208"):
        sainsot_compliance(thin, 0.4)


class TestShares:
    def test_equal(self) -> None:
        path = REFERENCE.path
        s = np.array([path.a, 0.5 * (path.a + path.b), path.c, 0.5 * (path.d + path.e), path.e])
        assert np.array_equal(equal_share(REFERENCE, s), [0.5, 0.5, 1.0, 0.5, 0.5])
        assert np.array_equal(equal_share(REFERENCE, [0.0, path.e + 1e-3]), [0.0, 0.0])

    def test_stiffness_shares_sum_to_one_and_follow_the_stiffness(self) -> None:
        pair = REFERENCE
        s = pair.path.a + np.linspace(0.0, 0.999, 40) * pair.base_pitch
        ahead = s + pair.base_pitch
        total = stiffness_share(pair, s) + np.where(
            ahead < pair.path.e, stiffness_share(pair, ahead), 0.0
        )
        assert np.allclose(total, 1.0, rtol=1e-14)
        k = pair_stiffness(pair, [s[5], ahead[5]])
        assert float(stiffness_share(pair, s[5])) == pytest.approx(k[0] / k.sum(), rel=1e-14)
        assert float(stiffness_share(pair, pair.path.c)) == 1.0
        assert float(stiffness_share(pair, 0.0)) == 0.0


def test_the_textbook_sum_is_too_stiff_and_most_where_the_body_is_deep() -> None:
    """Beside finite elements, bores held: the range stated in the documentation, and its trend."""
    over = []
    for bore in (0.5, 0.7):
        gears = [
            Gear(z, 5e-3, face_width=25e-3, bore_radius=bore * Gear(z, 5e-3).root_radius)
            for z in (25, 75)
        ]
        pair = GearPair(*gears)
        more = pair.contact_ratio - 1.0
        phase = np.array([0.5 * more, 0.5 * (1.0 + more)])  # two pairs, one pair
        finite = finite_stiffness(pair, 100e3 * pair.face_width, phase).secant
        over.append(mesh_stiffness(pair, phase) / finite - 1.0)
    double, single = np.transpose(over)
    assert np.all((double > 0.11) & (double < 0.68))
    assert np.all((single > 0.05) & (single < 0.17))
    assert double[0] > double[1] + 0.1
