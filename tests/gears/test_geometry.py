"""Geometry against closed forms, line/circle intersections, symmetries and refusals."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from conftest import Compared
from thermogear.base.errors import GeometryError, InputError, ValidityWarning
from thermogear.gears.geometry import Gear, Rack, inverse_involute, involute
from thermogear.gears.pair import GearPair

RIG = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))


def random_pairs(count: int, seed: int = 1) -> list[GearPair]:
    """Valid pairs with random teeth, shifts, modules, pressure angles and centre distances."""
    rng = np.random.default_rng(seed)
    pairs: list[GearPair] = []
    while len(pairs) < count:
        m = float(rng.uniform(0.5e-3, 20e-3))
        alpha = math.radians(float(rng.uniform(14.5, 25.0)))
        gears = []
        try:
            for _ in range(2):
                gears.append(
                    Gear(
                        int(rng.integers(8, 140)),
                        m,
                        pressure_angle=alpha,
                        profile_shift=float(rng.uniform(-0.4, 0.8)),
                        rack=Rack(
                            addendum=float(rng.uniform(0.8, 1.0)),
                            dedendum=1.25,
                            fillet_radius=float(rng.uniform(0.1, 0.3)),
                        ),
                    )
                )
            tight = GearPair(*gears)
            pairs.append(
                GearPair(*gears, centre_distance=tight.centre_distance + m * rng.uniform(0, 0.05))
            )
        except GeometryError:
            continue
    return pairs


class TestInvolute:
    def test_inverse_undoes_the_involute_to_machine_precision(self, compared: Compared) -> None:
        alpha = np.linspace(-1.55, 1.55, 3001)
        compared(
            "inverse of the involute function [rad]",
            "the angle it began with",
            inverse_involute(involute(alpha)) - alpha,
            5e-15,
        )

    def test_involute_of_the_inverse(self) -> None:
        value = np.concatenate([np.logspace(-18, 3, 400)])
        assert np.abs(involute(inverse_involute(value)) / value - 1.0).max() < 2e-12

    def test_series_and_difference_agree_where_they_meet(self) -> None:
        from decimal import Decimal, getcontext

        getcontext().prec = 40
        a = Decimal("0.1")
        # tan from its power series in exact arithmetic
        sine = sum((-1) ** k * a ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(12))
        cosine = sum((-1) ** k * a ** (2 * k) / math.factorial(2 * k) for k in range(12))
        exact = float(sine / cosine - a)
        assert float(involute(np.nextafter(0.1, 0.0))) == pytest.approx(exact, rel=1e-14)
        assert float(involute(0.1)) == pytest.approx(exact, rel=1e-13)

    def test_zero_and_handbook_value(self) -> None:
        assert float(involute(0.0)) == 0.0
        assert float(inverse_involute(0.0)) == 0.0
        assert float(involute(math.radians(20.0))) == pytest.approx(0.01490438387, abs=5e-12)


class TestRig:
    def test_radii_and_path_of_contact(self, compared: Compared) -> None:
        figures = [
            RIG.pinion.base_radius,
            RIG.wheel.base_radius,
            RIG.centre_distance,
            RIG.base_pitch,
            *RIG.path,
        ]
        expected = [58.731, 176.192, 250.0, 14.760657, 7.9647, 18.5101, 21.3763, 22.7254, 33.2708]
        printed = [1e-3, 1e-3, 1e-9, 1e-6, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4]
        digits = (1e3 * np.array(figures) - expected) / printed
        compared(
            "radii, distances A to E of the rig, in units of the printed digit",
            "computed apart",
            digits,
            0.51,
        )
        compared("contact ratio of the rig", "computed apart", RIG.contact_ratio - 1.714426, 1e-6)
        assert RIG.normal_backlash == pytest.approx(0.0, abs=1e-15)
        assert RIG.ratio == 3.0

    def test_default_sizes_scale_with_the_module(self) -> None:
        gear = Gear(25, 5e-3)
        assert (gear.tip_radius, gear.face_width, gear.bore_radius) == (0.0675, 0.025, 0.025)

    def test_unstated_rack_ends_in_a_full_round_where_the_flanks_are_steep(self) -> None:
        assert Gear(25, 5e-3).rack == Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.38)
        steep = Gear(25, 5e-3, pressure_angle=math.radians(25.0))
        # the rack's half tip width there: pi/4 - h_fP tan(a) = rho (1 - sin a)/cos a
        width = math.pi / 4 - 1.25 * math.tan(math.radians(25.0))
        slope = (1.0 - math.sin(math.radians(25.0))) / math.cos(math.radians(25.0))
        assert steep.rack.fillet_radius == pytest.approx(width / slope, rel=1e-12)
        assert (steep.rack.addendum, steep.rack.dedendum) == (1.0, 1.25)
        # the tooth's foot then spans the whole pitch
        assert steep.root_half_angle == pytest.approx(math.pi / 25, rel=1e-12)
        # a rack that was asked for is not changed
        with pytest.raises(GeometryError, match=r"rack\.fillet_radius: got 0\.38 modules"):
            Gear(25, 5e-3, pressure_angle=math.radians(25.0), rack=Rack())

    def test_one_gear_given_twice_is_two_equal_gears(self) -> None:
        gear = Gear(30, 3e-3)
        pair = GearPair(gear, gear)
        assert pair.pinion is gear
        assert pair.wheel is not gear
        assert pair.wheel == gear


class TestRandomGears:
    @pytest.fixture(scope="class")
    @classmethod
    def pairs(cls) -> list[GearPair]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            return random_pairs(250)

    def test_contact_ratio_is_the_line_cut_by_the_tip_circles(
        self, pairs: list[GearPair], compared: Compared
    ) -> None:
        assert len(pairs) == 250
        differences = []
        for pair in pairs:
            p, w, a = pair.pinion, pair.wheel, pair.centre_distance
            # inner common tangent of the base circles, by plane vectors
            cosine = (p.base_radius + w.base_radius) / a
            normal = np.array([cosine, -math.sqrt(1.0 - cosine**2)])
            along = np.array([-normal[1], normal[0]])
            foot = p.base_radius * normal

            def cut(centre: np.ndarray, radius: float, side: float, o=foot, d=along) -> float:
                b = float((o - centre) @ d)
                c = float((o - centre) @ (o - centre)) - radius**2
                return -b + side * math.sqrt(b * b - c)

            end = cut(np.zeros(2), p.tip_radius, 1.0)
            start = cut(np.array([a, 0.0]), w.tip_radius, -1.0)
            differences.append((end - start) / p.base_pitch - pair.contact_ratio)
        compared(
            "contact ratio of 250 random pairs",
            "line of action cut by the tip circles, by plane vectors",
            differences,
            1e-9,
        )

    def test_swapping_the_gears_mirrors_the_path(self, pairs: list[GearPair]) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            for pair in pairs[:200]:
                other = pair.swapped()
                mirrored = [pair.line_of_action - s for s in reversed(other.path)]
                assert np.allclose(mirrored, pair.path, rtol=0, atol=1e-12)
                assert other.contact_ratio == pytest.approx(pair.contact_ratio, abs=1e-12)
                assert other.normal_backlash == pytest.approx(pair.normal_backlash, abs=1e-14)

    def test_the_module_is_only_a_scale(self, pairs: list[GearPair]) -> None:
        def scaled(gear: Gear) -> Gear:
            return Gear(
                gear.teeth,
                2.0 * gear.module,
                pressure_angle=gear.pressure_angle,
                profile_shift=gear.profile_shift,
                rack=gear.rack,
            )

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            for pair in pairs[:200]:
                twice = GearPair(
                    scaled(pair.pinion), scaled(pair.wheel), 2.0 * pair.centre_distance
                )
                assert twice.contact_ratio == pytest.approx(pair.contact_ratio, abs=1e-12)
                assert np.allclose(twice.path, 2.0 * np.array(pair.path), rtol=1e-12)
                assert twice.pinion.root_half_angle == pytest.approx(
                    pair.pinion.root_half_angle, rel=1e-14
                )

    def test_backlash_is_the_gap_on_the_rolling_circles(self, pairs: list[GearPair]) -> None:
        for pair in pairs[:200]:
            r1, r2 = pair.operating_radii
            pitch = 2.0 * math.pi * r1 / pair.pinion.teeth
            thick = 2.0 * r1 * float(pair.pinion.half_thickness_angle(r1))
            thick += 2.0 * r2 * float(pair.wheel.half_thickness_angle(r2))
            gap = (pitch - thick) * math.cos(pair.operating_pressure_angle)
            assert pair.normal_backlash == pytest.approx(gap, abs=1e-12)
            assert pair.normal_backlash >= -1e-12

    def test_flank_and_fillet_meet_with_one_tangent(self, pairs: list[GearPair]) -> None:
        plain = [pair.pinion for pair in pairs if not pair.pinion.undercut]
        assert len(plain) > 125
        for gear in plain[:300]:
            gamma, t = gear.junction
            x, y = gear.fillet.point(gamma)
            radius = float(np.hypot(x, y))
            assert radius == pytest.approx(gear.form_radius, rel=1e-12)
            assert float(np.arctan2(x, y)) == pytest.approx(
                float(gear.half_thickness_angle(radius)), abs=1e-9
            )
            # the normal of both: gamma - phi on the fillet, t - theta_b on the involute
            assert gamma - float(gear.fillet.roll(gamma)) == pytest.approx(
                t - gear.base_half_angle, abs=1e-12
            )


class TestFillet:
    def test_bottom_touches_the_root_circle_at_the_foot_angle(self) -> None:
        gear = Gear(25, 5e-3)
        x, y = gear.fillet.point(0.5 * math.pi)
        assert float(np.hypot(x, y)) == pytest.approx(gear.root_radius, rel=1e-14)
        assert float(np.arctan2(x, y)) == pytest.approx(gear.root_half_angle, rel=1e-14)

    def test_height_rate_is_the_derivative(self) -> None:
        gear = Gear(31, 2e-3, profile_shift=0.2)
        gamma = np.linspace(0.4, 1.5, 12)
        h = 1e-6
        by_difference = (gear.fillet.point(gamma + h)[1] - gear.fillet.point(gamma - h)[1]) / (
            2 * h
        )
        assert np.allclose(gear.fillet.height_rate(gamma), by_difference, rtol=1e-7, atol=1e-12)

    def test_undercut_fillet_cuts_the_involute_above_the_base_circle(self) -> None:
        gear = Gear(10, 5e-3, allow_undercut=True)
        gamma, t = gear.junction
        assert gear.form_radius > gear.base_radius * (1 + 1e-4)
        x, y = gear.fillet.point(gamma)
        assert float(np.arctan2(x, y)) == pytest.approx(
            float(gear.half_thickness_angle(gear.form_radius)), abs=1e-12
        )
        # just above the crossing the fillet lies outside the tooth, just below inside
        assert t > 0.0

    def test_crossing_is_continuous_with_the_tangent_junction(self) -> None:
        limit = Gear(12, 5e-3, profile_shift=0.29814).junction[1]
        barely = Gear(12, 5e-3, profile_shift=0.2970, allow_undercut=True).junction[1]
        assert limit < 0.02
        assert barely < 0.1


def message(call: object) -> str:
    with pytest.raises(InputError) as caught:
        call()  # type: ignore[operator]
    text = str(caught.value)
    assert "\n" not in text
    return text


class TestRefusals:
    def test_undercut_names_shift_and_teeth(self) -> None:
        assert message(lambda: GearPair(Gear(12, 5e-3), Gear(40, 5e-3))) == (
            "pinion.profile_shift: got 0 for 12 teeth; undercut takes 4.31566 mm of the path of "
            "contact; use x >= 0.22 or >= 16 teeth, where what is cut lies below the flank in use, "
            "or allow_undercut (`new --allow-undercut`) to have the rest of the path"
        )
        assert Gear(12, 5e-3, profile_shift=0.30).minimum_teeth == 12
        assert Gear(18, 5e-3).teeth == 18

    def test_error_takes_its_part_as_prefix(self) -> None:
        with pytest.raises(GeometryError) as caught:
            GearPair(Gear(12, 5e-3), Gear(40, 5e-3))
        named = str(caught.value.under("gears"))
        assert named.startswith("gears.pinion.profile_shift: got 0 for 12")

    def test_shifts_that_leave_a_pressure_angle_of_zero_leave_no_mesh(self) -> None:
        """inv(alpha) + 2 tan(alpha)(x1 + x2)/(z1 + z2) = 0, also where it is exactly 0."""
        alpha = math.radians(20.0)
        inv, exact = float(involute(alpha)), 0
        for z in range(40, 60):
            shift = -inv * z / (2.0 * math.tan(alpha))
            for other in (math.nextafter(shift, -2.0), shift, math.nextafter(shift, 0.0)):
                left = inv + 2.0 * math.tan(alpha) * (shift + other) / (2 * z)
                if left <= 0.0:
                    exact += left == 0.0
                    gears = (Gear(z, 5e-3, profile_shift=x) for x in (shift, other))
                    text = message(lambda gears=gears: GearPair(*gears))
                    got = f"{other:g}; the sum of the shifts {shift + other:g}"
                    assert text == (
                        f"wheel.profile_shift: got {got} leaves no meshing position; "
                        "raise a profile shift"
                    )
        assert exact > 0

    def test_pointed_tooth_names_the_radius_of_its_point(self) -> None:
        text = message(lambda: Gear(20, 5e-3, profile_shift=1.5))
        assert text.startswith("tip_radius: got 62.5 mm; allowed < 61.848 mm; the tooth is pointed")
        gear = Gear(20, 5e-3, profile_shift=1.5, tip_radius=61.0e-3)
        root = brentq(lambda r: float(gear.half_thickness_angle(r)), 0.05, 0.07, xtol=1e-15)
        assert gear.pointed_radius == pytest.approx(root, rel=1e-12)

    @pytest.mark.parametrize(
        ("changes", "text"),
        [
            (
                {"module": -5e-3},
                "module: got -0.005 m (-5 mm); allowed 0.05..100 mm",
            ),
            ({"module": math.nan}, "module: got nan m; allowed 0.05..100 mm"),
            ({"module": "5 mm"}, "module: got '5 mm'; allowed a number [m]"),
            ({"teeth": 4}, "teeth: got 4; allowed 5..2000"),
            ({"teeth": 25.5}, "teeth: got 25.5; allowed a whole number, 5..2000"),
            ({"teeth": True}, "teeth: got True; allowed a whole number, 5..2000"),
            (
                {"pressure_angle": 0.7},
                "pressure_angle: got 0.7 rad (40.107 deg); allowed 10..35 deg",
            ),
            ({"pressure_angle": math.nan}, "pressure_angle: got nan rad; allowed 10..35 deg"),
            ({"face_width": 0.0}, "face_width: got 0 m (0 mm); allowed 0.01..10000 mm"),
            ({"face_width": math.inf}, "face_width: got inf m; allowed 0.01..10000 mm"),
            ({"roughness": -1e-6}, "roughness: got -1e-06 m (-1 um); allowed 0.001..100 um"),
            ({"profile_shift": math.inf}, "profile_shift: got inf modules; allowed -2..2 modules"),
            (
                {"bore_radius": 0.06},
                "bore_radius: got 60 mm; allowed < root radius 56.25 mm; the body must be a ring",
            ),
            (
                {"bore_radius": 0.0},
                "bore_radius: got 0 m (0 mm); allowed 0.01..10000 mm",
            ),
            (
                {"tip_radius": 0.0585},
                "tip_radius: got 58.5 mm; allowed > 59.1183 mm (form circle); "
                "no involute flank is left",
            ),
            (
                {"rack": Rack(fillet_radius=0.5)},
                "rack.fillet_radius: got 0.5 modules; allowed <= 0.4719 modules; "
                "the rack's tip is not wide enough for two such rounds; "
                "give the rack a smaller one",
            ),
        ],
    )
    def test_impossible_gears(self, changes: dict[str, object], text: str) -> None:
        arguments: dict[str, object] = {"teeth": 25, "module": 5e-3} | changes
        assert message(lambda: Gear(**arguments)) == text  # type: ignore[arg-type]

    def test_rack_and_hopeless_undercut(self) -> None:
        assert message(lambda: Rack(addendum=0.0)) == ("rack.addendum: got 0 modules; allowed > 0")
        assert message(lambda: Gear(5, 5e-3, profile_shift=-0.9, allow_undercut=True)) == (
            "tip_radius: got 13 mm; allowed > 13.3952 mm (form circle); no involute flank is left"
        )

    def test_pair_of_different_racks(self) -> None:
        assert message(lambda: GearPair(Gear(25, 5e-3), Gear(75, 4e-3))) == (
            "wheel.module: got 4 mm; allowed 5 mm, the pinion's; both gears come from one rack"
        )
        assert message(
            lambda: GearPair(
                Gear(25, 5e-3),
                Gear(75, 5e-3, pressure_angle=math.radians(25), rack=Rack(fillet_radius=0.3)),
            )
        ).startswith("wheel.pressure_angle: got 25 deg; allowed 20 deg, the pinion's")

    def test_jammed_centre_distance(self) -> None:
        assert message(lambda: GearPair(Gear(25, 5e-3), Gear(75, 5e-3), 0.2499)) == (
            "centre_distance: got 249.9 mm; allowed >= 250 mm; "
            "the teeth would wedge (no backlash left)"
        )
        assert message(lambda: GearPair(Gear(25, 5e-3), Gear(75, 5e-3), math.inf)).startswith(
            "centre_distance: got inf m"
        )

    def test_interference_names_the_longest_tip(self) -> None:
        wheel = Gear(75, 5e-3, tip_radius=0.1955)
        text = message(lambda: GearPair(Gear(18, 5e-3), wheel))
        assert text.startswith("wheel.tip_radius: got 195.5 mm; allowed <= ")
        longest = float(text.split("allowed <= ")[1].split(" mm")[0]) * 1e-3
        GearPair(Gear(18, 5e-3), Gear(75, 5e-3, tip_radius=longest * (1 - 1e-6)))

    def test_profile_shifts_without_a_meshing_position_or_clearance(self) -> None:
        few = Gear(26, 5e-3, profile_shift=-0.45, allow_undercut=True)
        text = message(
            lambda: GearPair(
                Gear(26, 5e-3, profile_shift=-1.3, allow_undercut=True, tip_radius=64.9e-3), few
            )
        )
        assert text == (
            "wheel.profile_shift: got -0.45; the sum of the shifts -1.75 leaves no meshing "
            "position; raise a profile shift"
        )
        flat = Gear(60, 5e-3, rack=Rack(addendum=1.0, dedendum=1.0, fillet_radius=0.0))
        assert message(lambda: GearPair(flat, flat)) == (
            "wheel.tip_radius: got 155 mm; allowed < 155 mm; "
            "the tip hits the pinion's root (clearance 0 mm)"
        )

    def test_root_circle_that_vanishes(self) -> None:
        text = message(lambda: Gear(5, 5e-3, profile_shift=-1.3, allow_undercut=True))
        assert text == "profile_shift: got -1.3; the root circle vanishes"

    def test_contact_ratio(self) -> None:
        def short(tip: float) -> GearPair:
            return GearPair(
                Gear(25, 5e-3, tip_radius=62.5e-3 + tip), Gear(75, 5e-3, tip_radius=187.5e-3 + tip)
            )

        assert message(lambda: short(2.0e-3)).startswith("contact_ratio: got 0.7")
        with pytest.warns(ValidityWarning, match=r"contact_ratio: got 1\.\d+; recommended >= 1\.2"):
            short(3.1e-3)


def test_an_undercut_that_cuts_the_tooth_off_is_refused():
    deep = Gear(8, 5e-3, pressure_angle=math.radians(20.0), profile_shift=-0.8, allow_undercut=True)
    gamma = np.linspace(deep.junction[0], 0.5 * math.pi, 400)
    assert deep.fillet.point(gamma)[0].min() > 0.0  # a thin neck, but one
    text = message(
        lambda: Gear(
            8, 5e-3, pressure_angle=math.radians(30.0), profile_shift=-1.11, allow_undercut=True
        )
    )
    assert text == (
        "profile_shift: got -1.11 for 8 teeth; the undercut cuts the tooth off; "
        "raise the profile shift (no undercut from 0.195)"
    )


class TestTipEdge:
    """A rounding or chamfer ends the involute below the tip circle, and the path with it."""

    @pytest.mark.parametrize(("teeth", "shift", "alpha"), [(12, 0.5, 20.0), (75, 0.0, 25.0)])
    @pytest.mark.parametrize("rounding", [0.02, 0.1, 0.25])
    def test_the_rounding_touches_flank_and_tip_circle(
        self, teeth: int, shift: float, alpha: float, rounding: float
    ) -> None:
        sharp = Gear(teeth, 5e-3, pressure_angle=math.radians(alpha), profile_shift=shift)
        size = rounding * min(sharp.tip_thickness, 5e-3)
        gear = Gear(
            teeth,
            5e-3,
            pressure_angle=math.radians(alpha),
            profile_shift=shift,
            tip_rounding=size,
        )
        # the tooth's axis is the first axis; the circle's centre from the land's end
        centre = (gear.tip_radius - size) * np.exp(1j * 0.5 * gear.tip_land / gear.tip_radius)
        r = np.linspace(gear.form_radius, gear.tip_radius, 400_001)
        away = np.abs(r * np.exp(1j * gear.half_thickness_angle(r)) - centre)
        assert float(away.min()) == pytest.approx(size, rel=1e-8)
        assert float(r[away.argmin()]) == pytest.approx(gear.tip_form_radius, abs=1e-6)

    def test_a_small_rounding_shortens_the_path_to_first_order(self) -> None:
        size = 1e-6
        pair = GearPair(Gear(25, 5e-3, tip_rounding=size), Gear(75, 5e-3, tip_rounding=size))
        for gear, gone in (
            (RIG.pinion, RIG.path.e - pair.path.e),
            (RIG.wheel, pair.path.a - RIG.path.a),
        ):
            sine = math.sin(float(gear.pressure_angle_at(gear.tip_radius)))
            assert gone == pytest.approx(size * (1.0 - sine) / sine, rel=1e-3)

    def test_a_chamfer_ends_the_path_where_a_lower_tip_would(self) -> None:
        h = 0.3e-3
        chamfered = [Gear(g.teeth, g.module, tip_chamfer=h) for g in (RIG.pinion, RIG.wheel)]
        lower = [
            Gear(g.teeth, g.module, tip_radius=g.tip_radius - h) for g in (RIG.pinion, RIG.wheel)
        ]
        assert GearPair(*chamfered).path == GearPair(*lower).path
        assert chamfered[0].tip_radius == RIG.pinion.tip_radius
        assert chamfered[0].tip_land == pytest.approx(RIG.pinion.tip_thickness - 2.0 * h)

    def test_without_an_edge_all_is_as_drawn(self) -> None:
        gear = Gear(25, 5e-3, tip_rounding=0.0, tip_chamfer=0.0)
        assert (gear.tip_form_radius, gear.tip_land) == (gear.tip_radius, gear.tip_thickness)
        assert gear == RIG.pinion

    def test_an_edge_frees_a_tip_that_interferes(self) -> None:
        pinion, tip = Gear(20, 4e-3), 164.6e-3
        with pytest.raises(GeometryError, match="interference"):
            GearPair(pinion, Gear(80, 4e-3, tip_radius=tip))
        for rounding, chamfer in ((0.0, 0.4e-3), (0.8e-3, 0.0)):
            wheel = Gear(80, 4e-3, tip_radius=tip, tip_rounding=rounding, tip_chamfer=chamfer)
            pair = GearPair(pinion, wheel)
            assert pair.path.a > pinion.base_radius * pinion.junction[1]
            assert pair.wheel.tip_radius == tip

    @pytest.mark.parametrize("name", ["tip_rounding", "tip_chamfer"])
    def test_an_edge_that_takes_the_land_is_refused_and_the_limit_holds(self, name: str) -> None:
        gear = Gear(20, 4e-3)

        def values(size: float) -> dict[str, Any]:
            return {name: size}

        with pytest.raises(GeometryError) as caught:
            replace(gear, **values(3e-3))
        largest = {"tip_rounding": "2.28008", "tip_chamfer": "1.38976"}[name]
        assert str(caught.value) == (
            f"{name}: got 3 mm; allowed < {largest} mm; no tip land or no involute flank is "
            "left; make the edge smaller"
        )
        allowed = 1e-3 * float(largest)
        assert 0.0 < replace(gear, **values(allowed * (1.0 - 1e-4))).tip_land < 1e-3 * 4e-3
        with pytest.raises(GeometryError):
            replace(gear, **values(allowed * (1.0 + 1e-4)))

    def test_both_edges_at_once_are_refused(self) -> None:
        with pytest.raises(InputError) as caught:
            Gear(20, 4e-3, tip_rounding=1e-4, tip_chamfer=2e-4)
        assert str(caught.value) == (
            "tip_chamfer: got 0.2 mm; allowed 0 mm; the tip has a rounding of 0.1 mm too; "
            "give one of the two"
        )
