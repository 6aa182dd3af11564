"""Life, viscosity ratio and friction: published figures, steps, limits, random bearings."""

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing
from thermogear.shafts.bearings.friction import PalmgrenFriction, SkfFriction, has_skf
from thermogear.shafts.bearings.life import life_factor, rating_life, viscosity_ratio

RPM = np.pi / 30.0


def test_life_factor_is_smooth_enough_and_bounded(compared: Compared) -> None:
    """ISO 281's branches meet at 0.4 and 1; 0.1 without film or with dirt; 50 at most."""
    steps = []
    for kind in ("ball", "roller"):
        for kappa in (0.4, 1.0):
            for r in (0.01, 0.1, 0.3):
                sides = life_factor(
                    kind, viscosity_ratio=np.array([kappa - 1e-12, kappa]), fatigue_ratio=r
                )
                steps.append(sides[1] / sides[0] - 1.0)
        kappas, ratios = np.geomspace(0.1, 8.0, 60), np.geomspace(1e-3, 5.0, 40)
        whole = life_factor(kind, viscosity_ratio=kappas[:, None], fatigue_ratio=ratios)
        assert whole.shape == (60, 40)
        assert whole.min() >= 0.1
        assert whole.max() == 50.0
        assert np.diff(whole, axis=0).min() > -1e-3
        assert np.all(np.diff(whole, axis=1) >= 0.0)
        above = life_factor(kind, viscosity_ratio=[4.0, 40.0], fatigue_ratio=0.2)
        assert above[0] == above[1]
        assert float(life_factor(kind, viscosity_ratio=1.0, fatigue_ratio=0.0)) == 0.1
        assert float(life_factor(kind, viscosity_ratio=1.0, fatigue_ratio=1e9)) == 50.0
        assert np.isnan(float(life_factor(kind, viscosity_ratio=0.09, fatigue_ratio=1.0)))
        assert np.isnan(float(life_factor(kind, viscosity_ratio=np.nan, fatigue_ratio=1.0)))
    compared("a_ISO at the borders of its branches", "no step", steps, 2e-3)
    # at kappa 0.1 the film's term of balls vanishes whatever the load
    thin = life_factor("ball", viscosity_ratio=0.1, fatigue_ratio=0.5)
    assert float(thin) == pytest.approx(0.1, rel=1e-2)
    with pytest.raises(InputError, match="kind"):
        life_factor("needle", viscosity_ratio=1.0, fatigue_ratio=1.0)


@pytest.mark.parametrize(
    ("kind", "kappa", "known"),
    [
        # (1 - (2.5671 - A/kappa^B)^0.83 r^(1/3))^-9.3/10 at r = 0.1, by hand
        ("ball", 0.2, (1 - (2.5671 - 2.2649 / 0.2**0.054381) ** 0.83 * 0.1 ** (1 / 3)) ** -9.3),
        ("ball", 0.7, (1 - (2.5671 - 1.9987 / 0.7**0.19087) ** 0.83 * 0.1 ** (1 / 3)) ** -9.3),
        ("ball", 3.0, (1 - (2.5671 - 1.9987 / 3.0**0.071739) ** 0.83 * 0.1 ** (1 / 3)) ** -9.3),
        ("roller", 0.2, (1 - (1.5859 - 1.3993 / 0.2**0.054381) * 0.1**0.4) ** -9.185),
        ("roller", 0.7, (1 - (1.5859 - 1.2348 / 0.7**0.19087) * 0.1**0.4) ** -9.185),
        ("roller", 3.0, (1 - (1.5859 - 1.2348 / 3.0**0.071739) * 0.1**0.4) ** -9.185),
    ],
)
def test_life_factor_by_hand(kind: str, kappa: float, known: float) -> None:
    found = float(life_factor(kind, viscosity_ratio=kappa, fatigue_ratio=0.1))
    assert found == pytest.approx(0.1 * known, rel=1e-12)


def test_viscosity_ratio_over_speed(compared: Compared) -> None:
    one = catalogue_bearing("6205")
    n = np.array([10.0, 100.0, 999.999, 1000.001, 3000.0, 20000.0])
    found = viscosity_ratio(one, viscosity=20e-6, speed=n * RPM)
    slow, fast = 45000.0 * n**-0.83 * 38.5**-0.5, 4500.0 * (n * 38.5) ** -0.5
    known = 20.0 / np.where(n < 1000.0, slow, fast)
    compared("kappa of a 6205", "ISO 281 by hand", found / known - 1.0, 1e-12)
    assert abs(found[3] / found[2] - 1.0) < 0.025
    assert float(viscosity_ratio(one, viscosity=20e-6, speed=0.0)) == 0.0
    assert viscosity_ratio(one, viscosity=np.full((4, 1), 1e-5), speed=n).shape == (4, 6)


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
