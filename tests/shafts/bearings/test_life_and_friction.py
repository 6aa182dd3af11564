"""Life, viscosity ratio and friction: published figures, steps, limits, random bearings."""

import numpy as np
import pytest

from conftest import Compared
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing
from thermogear.shafts.bearings.friction import PalmgrenFriction, SkfFriction, has_skf
from thermogear.shafts.bearings.life import rating_life

RPM = np.pi / 30.0


def test_life_falls_by_the_power_of_the_load() -> None:
    for one in CATALOGUE.values():
        power = 3.0 if one.kind == "ball" else 10.0 / 3.0
        lives = rating_life(one, np.array([1000.0, 2000.0, 0.0]))
        assert lives[0] / lives[1] == pytest.approx(2.0**power)
        assert np.isinf(lives[2])


def test_friction_of_a_6205_by_its_parts(compared: Compared) -> None:
    """14.3 rolling + 6.3 sliding N mm at 1000 N, 40.8 at 2000 N, 6.5 W."""
    one, speed = catalogue_bearing("6205"), 3000.0 * RPM
    skf = SkfFriction(bearing=one)
    found = 1e3 * skf.moment(force=np.array([1000.0, 2000.0]), speed=speed, viscosity=20e-6)
    compared("SKF's friction of a 6205", "20.6, 40.8 N mm", found / [20.6, 40.8] - 1.0, 3e-3)
    # mu S1 d_m^-0.26 F^(5/3) alone, the oil so thin that nothing rolls it
    thin = 1e3 * float(skf.moment(force=1000.0, speed=1.0, viscosity=1e-12))
    boundary = 0.12 * 3.23e-3 * 38.5**-0.26 * 1000.0 ** (5 / 3)
    assert thin == pytest.approx(boundary, rel=1e-3)
    watts = float(skf.moment(force=1000.0, speed=speed, viscosity=20e-6)) * speed
    compared("its loss", "6.5 W; 1.047e-4 n M", [watts / 6.5 - 1, watts / (0.10472 * 3 * 20.6) - 1],
             6e-3)  # fmt: skip


def test_skf_by_hand_where_inlet_and_starving_count(compared: Compared) -> None:
    """6308 in grease, 6000 rpm, 80 mm^2/s, 3000 N: every factor far from one."""
    n, nu, load, d, outside = 6000.0, 80.0, 3000.0, 40.0, 90.0
    dm = 0.5 * (d + outside)
    inlet = 1.0 / (1.0 + 1.84e-9 * (n * dm) ** 1.28 * nu**0.64)
    left = np.exp(-6e-8 * nu * n * (d + outside) * np.sqrt(3.1 / (2.0 * (outside - d))))
    weight = np.exp(-2.6e-8 * (n * nu) ** 1.4 * dm)
    rolling = inlet * left * 3.7e-7 * dm**1.96 * load**0.54 * (nu * n) ** 0.6
    mu = 0.12 * weight + 0.04 * (1.0 - weight)
    known = rolling + mu * 2.84e-3 * dm**-0.26 * load ** (5 / 3)
    assert inlet < 0.7
    assert left < 0.7
    law = SkfFriction(bearing=catalogue_bearing("6308"), lubrication="grease", sliding=0.04)
    found = 1e3 * float(law.moment(force=load, speed=n * RPM, viscosity=nu * 1e-6))
    compared("SKF's friction of a 6308", "by hand", found / known - 1.0, 1e-12)


def test_limits_of_random_friction(compared: Compared) -> None:
    """Palmgren: (nu w)^(2/3), linear in load; both even in speed, none at rest, shapes kept."""
    rng = np.random.default_rng(67)
    powers = []
    names = list(CATALOGUE)
    for _ in range(50):
        one = CATALOGUE[names[rng.integers(len(names))]]
        law = PalmgrenFriction(bearing=one, lubrication=str(rng.choice(["bath", "grease", "jet"])))
        laws = [law, SkfFriction(bearing=one)] if has_skf(one) else [law]
        speed, nu, load = rng.uniform(300, 3000), rng.uniform(5e-6, 3e-4), rng.uniform(10, 4e3)
        for each in laws:
            here = each.moment(force=load, speed=speed, viscosity=nu)
            assert here > 0.0
            assert here == each.moment(force=-load, speed=-speed, viscosity=nu)
            assert each.moment(force=load, speed=0.0, viscosity=nu) == 0.0
            shape = each.moment(
                force=np.ones((3, 1, 1)), speed=np.ones((4, 1)), viscosity=np.full(5, nu)
            ).shape
            assert shape == (3, 4, 5)
            more = each.moment(force=load * np.arange(1, 6), speed=speed, viscosity=nu)
            assert np.all(np.diff(more) > 0.0)
        oil, faster = (
            float(law.moment(force=0.0, speed=w, viscosity=nu)) for w in (speed, 8.0 * speed)
        )
        powers.append(faster / oil / 4.0 - 1.0)
        lifted = float(law.moment(force=load, speed=speed, viscosity=nu)) - oil
        twice = float(law.moment(force=2 * load, speed=speed, viscosity=nu)) - oil
        assert twice == pytest.approx(2.0 * lifted, rel=1e-9)
    compared("oil's moment at eight times the speed", "four times", powers, 1e-9)
