"""Losses: the loss factor against its own integral, published cases, momentum and units."""

import numpy as np
import pytest
from scipy.integrate import simpson

from conftest import Compared
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.heat.laws import schlenk
from thermogear.heat.losses import (
    bearing_loss,
    churning_loss,
    efficiency,
    gear_loss_factor,
    mesh_loss,
)


def fzg_c() -> GearPair:
    """16/24, module 4.5 mm, x 0.1817/0.1715, b 14 mm."""
    pinion = Gear(16, 4.5e-3, profile_shift=0.1817, face_width=0.014, bore_radius=0.015)
    wheel = Gear(24, 4.5e-3, profile_shift=0.1715, face_width=0.014, bore_radius=0.02)
    return GearPair(pinion, wheel, centre_distance=0.0915003)


def factor_of(pair: GearPair) -> float:
    path, pitch = pair.path, pair.base_pitch
    approach, recess = (path.c - path.a) / pitch, (path.e - path.c) / pitch
    return float(
        gear_loss_factor(
            teeth_1=pair.pinion.teeth, ratio=pair.ratio, approach=approach, recess=recess
        )
    )


def test_published_loss_factor_and_loss_of_fzg_c(compared: Compared) -> None:
    """H_V 0.1986; 200 Nm at 1500 1/min with mu 0.0449: 280.0 W."""
    pair = fzg_c()
    factor = factor_of(pair)
    compared("loss factor of the FZG C gears", "GEARpie's result, 0.1986", factor - 0.1986, 1e-4)
    mu = schlenk(5912.1 / 0.014, 4.38893, 8.38224e-3, 13.28e-3, 0.355e-6)
    loss = mesh_loss(200.0 * 1500.0 * np.pi / 30.0, mu, factor)
    compared("mesh loss of the FZG C gears", "280.0 W, computed apart", loss / 280.0 - 1.0, 1e-3)


def test_published_loss_factor_of_a_30_30_pair() -> None:
    """Module 2 mm, 30/30, a = 60 mm: H_V 0.1494, contact ratio 1.65, path 9.76 mm."""
    pair = GearPair(Gear(30, 2e-3), Gear(30, 2e-3), centre_distance=0.060)
    assert factor_of(pair) == pytest.approx(0.1494, abs=1e-4)
    assert pair.contact_ratio == pytest.approx(1.65, abs=5e-3)
    assert (pair.path.e - pair.path.a) * 1e3 == pytest.approx(9.76, abs=5e-3)


@pytest.mark.parametrize("pair", [fzg_c(), GearPair(Gear(25, 5e-3), Gear(75, 5e-3))])
def test_loss_factor_is_its_own_integral(pair: GearPair, compared: Compared) -> None:
    """Mean of |v_s| times the halved load over the transmitted power, piece by piece."""
    path, pitch = pair.path, pair.base_pitch
    lost = 0.0
    for start, end, share in (
        (path.a, path.b, 0.5),
        (path.b, path.c, 1.0),
        (path.c, path.d, 1.0),
        (path.d, path.e, 0.5),
    ):
        s = np.linspace(start, end, 201)
        lost += simpson(share * np.abs(s - path.c), x=s)
    slip = (1.0 + 1.0 / pair.ratio) / pair.pinion.base_radius
    compared(
        "loss factor",
        "its integral over the path",
        slip * lost / pitch / factor_of(pair) - 1.0,
        1e-9,
    )


def test_churning_is_torque_times_speed_and_grows_with_both() -> None:
    speed = np.array([0.0, 50.0, 100.0])
    loss = churning_loss(speed, 0.1, 850.0, 4e-5, 0.4)
    assert loss[0] == 0.0
    assert loss[2] / loss[1] == pytest.approx(2.0**2.5, rel=1e-12)  # laminar


def test_bearing_and_efficiency() -> None:
    assert bearing_loss(2000.0, 0.03, 100.0) == pytest.approx(0.0015 * 2000.0 * 0.015 * 100.0)
    assert efficiency(power=1000.0, loss=20.0) == pytest.approx(0.98)
    assert efficiency(power=0.5, loss=0.1) == pytest.approx(0.8)
    assert np.isnan(efficiency(power=0.0, loss=20.0))
