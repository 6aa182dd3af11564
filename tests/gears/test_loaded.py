"""Loaded tooth contact: published figures, equilibrium, invariances, limits, hot tables."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.gears.contact import back_flank_position
from thermogear.gears.deviations import BasePitchDifference, PathTable, Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LoadedModel, loaded_contact, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.ring import ring_compliance
from thermogear.gears.sharing_kernel import _half_width
from thermogear.gears.stiffness import CONTACT_LAWS, Moduli, weber_approach
from thermogear.gears.tooth import flank_point, tooth_compliances
from thermogear.gears.touch import first_touch

WIDTH = 20e-3
PAIR = GearPair(
    Gear(25, 5e-3, face_width=WIDTH, bore_radius=20e-3),
    Gear(75, 5e-3, face_width=WIDTH, bore_radius=60e-3),
)
# the figures below were computed apart with the beam on a ring
UNCOUPLED_LINEAR = LoadedModel(
    tooth="beam", body="bore_clamped", contact="yang-sun", coupled=False, extended=False
)
CLAMPED = LoadedModel(tooth="beam", body="bore_clamped")
IN_PATH = LoadedModel(tooth="beam", body="bore_clamped", extended=False)
RIM = LoadedModel(tooth="beam")
EXPANSION = 11.5e-6


def per_width(values: object) -> np.ndarray:
    """N/m -> N/(mm um)."""
    return np.asarray(values) / WIDTH / 1e9


def two_pairs(data: object) -> np.ndarray:
    return np.asarray((data.contact_pairs > 1).mean("mesh_phase"))  # type: ignore[attr-defined]


class TestPublishedFigures:
    @pytest.mark.parametrize(
        ("extended", "stiffness", "error", "fraction"),
        [
            (True, (15.040, 11.480, 15.799), (13.998, 5.043), 0.860),
            (False, (14.473, 11.380, 15.799), (14.454, 5.197), 0.715),
        ],
    )
    def test_whole_mesh_at_200_n_per_mm(
        self,
        extended: bool,
        stiffness: tuple[float, ...],
        error: tuple[float, ...],
        fraction: float,
        compared: Compared,
    ) -> None:
        got = loaded_contact(PAIR, 200e3 * WIDTH, model=replace(CLAMPED, extended=extended))
        k = per_width(got.tangent_stiffness)
        got_k = np.array([k.mean(), k.min(), k.max()])
        compared(
            "mesh stiffness at 200 N/mm: mean, least, greatest",
            "computed apart",
            got_k / stiffness - 1.0,
            5e-3,
        )
        te = 1e6 * got.transmission_error.to_numpy()
        got_te = np.array([te.mean(), np.ptp(te)])
        compared(
            "transmission error at 200 N/mm: mean, swing",
            "computed apart",
            got_te / error - 1.0,
            1e-2,
        )
        assert float(two_pairs(got)) == pytest.approx(fraction, abs=0.005)
        assert float(got.double_contact_length) == pytest.approx(
            fraction * PAIR.base_pitch, rel=0.01
        )

    def test_load_dependence(self, compared: Compared) -> None:
        loads = np.array([20.0, 50.0, 100.0, 200.0, 400.0, 800.0]) * 1e3 * WIDTH
        got = loaded_contact(PAIR, loads, model=CLAMPED)
        known = np.array([13.878, 14.292, 14.644, 15.040, 15.521, 16.067])
        compared(
            "mean stiffness at 20 to 800 N/mm",
            "computed apart",
            per_width(got.mean_stiffness) / known - 1.0,
            1.2e-2,  # of tip corners taken for flanks
        )
        assert two_pairs(got) == pytest.approx([0.760, 0.790, 0.820, 0.860, 0.920, 0.995], abs=6e-3)

    @pytest.mark.parametrize(
        ("tooth", "apart", "moved"), [("solved", 6e-3, 3e-3), ("beam", 0.03, 0.015)]
    )
    def test_finite_elements(
        self, tooth: str, apart: float, moved: float, compared: Compared
    ) -> None:
        """2-D plane stress, quadratic elements, contact mesh converged; no corner contact."""
        phase = np.array([0.030, 0.245, 0.460, 0.674, 0.724, 0.857, 0.990])
        got = loaded_contact(PAIR, 200e3 * WIDTH, phase, model=replace(IN_PATH, tooth=tooth))
        elements = np.array([15.09, 15.41, 15.42, 15.13, 11.13, 11.26, 11.26])
        compared(
            f"secant stiffness over the mesh, {tooth} teeth",
            "finite elements computed apart, m 5, 25:75",
            per_width(got.secant_stiffness) / elements - 1.0,
            apart,
        )
        share = got.load_share[:4, 1].to_numpy()
        compared(
            f"share of the load in double contact, {tooth} teeth",
            "finite elements computed apart, m 5, 25:75",
            share - [0.401, 0.457, 0.516, 0.580],
            moved,
        )

    def test_rim_reading_without_the_hub(self) -> None:
        clamped = loaded_contact(PAIR, 200e3 * WIDTH, model=IN_PATH)
        rim = loaded_contact(PAIR, 200e3 * WIDTH, model=replace(RIM, extended=False))
        assert per_width(clamped.mean_stiffness) == pytest.approx(14.49, rel=5e-3)
        assert per_width(rim.mean_stiffness) == pytest.approx(18.72, rel=5e-3)
        # a torsion of both hubs in series with everything else
        both = 3.78e-10 + 3.86e-10
        assert np.allclose(
            1.0 / clamped.tangent_stiffness, 1.0 / rim.tangent_stiffness + both, rtol=3e-3
        )
        assert np.allclose(clamped.load_share, rim.load_share, rtol=0, atol=1e-9)
        # under one load the hubs turn by the same angle all along: the error's swing knows none
        turned = (clamped.transmission_error - rim.transmission_error).to_numpy()
        assert turned == pytest.approx(both * 200e3 * WIDTH, rel=3e-3)
        assert np.ptp(turned) < 1e-9 * turned[0]


class TestHot:
    @pytest.mark.parametrize(
        ("celsius", "stiffness"),
        [(20, 3.7602e8), (100, 3.6625e8), (120, 3.6380e8), (140, 3.6215e8), (160, 3.5975e8)],
    )
    def test_modulus_of_temperature(
        self, celsius: float, stiffness: float, compared: Compared
    ) -> None:
        pair = GearPair(
            Gear(25, 5e-3, face_width=25e-3, bore_radius=20e-3),
            Gear(75, 5e-3, face_width=25e-3, bore_radius=60e-3),
        )
        hot = Moduli.at(pair.pinion, tooth=273.15 + celsius, body=273.15 + celsius)
        got = loaded_contact(pair, 200e3 * 25e-3, pinion=hot, wheel=hot, model=CLAMPED)
        compared(
            "mean stiffness from 20 to 160 °C",
            "computed apart",
            float(got.mean_stiffness) / stiffness - 1.0,
            8e-3,  # of tip corners taken for flanks
        )

    @pytest.mark.parametrize(
        ("line_load", "difference", "peak", "change", "fraction", "share"),
        [
            (100, 0, 2.63, None, 0.825, 0.49),
            (100, 20, 3.59, -0.002, 0.825, 0.24),
            (100, 40, 4.72, -0.126, 0.433, 0.00),
            (200, 20, 5.75, -0.002, 0.858, 0.36),
            (200, 40, 6.79, -0.004, 0.858, 0.23),
            (400, 0, 9.62, None, 0.917, 0.49),
            (400, 60, 11.73, -0.001, 0.917, 0.29),
        ],
    )
    def test_base_pitch_difference(
        self,
        line_load: float,
        difference: float,
        peak: float,
        change: float | None,
        fraction: float,
        share: float,
        compared: Compared,
    ) -> None:
        """The figures are those of 120 positions: a jump of the pairs is placed to one of them."""
        hot = [BasePitchDifference(EXPANSION * difference)]
        load = line_load * 1e3 * WIDTH
        got = loaded_contact(PAIR, load, 120, deviations=hot, model=RIM)
        te = 1e6 * got.transmission_error.to_numpy()
        compared(
            "swing of the transmission error, gears of different temperature",
            "computed apart",
            np.ptp(te) / peak - 1.0,
            0.015,  # of tip corners taken for flanks
        )
        got = loaded_contact(PAIR, load, 1200, deviations=hot, model=CLAMPED)
        assert float(two_pairs(got)) == pytest.approx(fraction, abs=1 / 120 + 5e-4)
        middle = round(0.5 * (PAIR.contact_ratio - 1.0) * 1200)
        assert float(got.load_share[middle, 1]) == pytest.approx(share, abs=0.006)
        if change is not None:
            cold = loaded_contact(PAIR, load, 1200, model=CLAMPED)
            got_change = float(got.mean_stiffness / cold.mean_stiffness) - 1.0
            assert got_change == pytest.approx(change, abs=0.003)

    def test_hotter_pinion_and_hotter_wheel_are_no_mirror_images(self) -> None:
        strain = EXPANSION * np.array([20.0, 0.0, -20.0])
        got = loaded_contact(PAIR, 100e3 * WIDTH, deviations=[BasePitchDifference(strain)])
        entering = got.load_share[:, 70, 1].to_numpy()
        assert entering[0] < entering[1] < entering[2]
        peak = np.ptp(got.transmission_error.to_numpy(), axis=-1)
        assert abs(peak[0] - peak[2]) > 0.015 * peak[1]


class TestEquilibrium:
    LOADS = np.array([[1.0], [4e3], [3e5]])

    def test_forces_carry_the_load_and_no_flank_pulls(self) -> None:
        relief = [
            Relief("wheel", amount=20e-6, length=4e-3),
            Relief("pinion", amount=10e-6, length=3e-3, shape="parabolic"),
        ]
        mesh = solve_mesh(PAIR, self.LOADS, np.arange(60) / 60, deviations=relief)
        assert np.all(mesh.settled)
        assert np.all(mesh.force >= 0.0)
        assert np.allclose(mesh.force.sum(axis=-1), self.LOADS[..., None], rtol=1e-11)

    def test_every_gap_closes_or_stays_open(self) -> None:
        """Overlap rebuilt from the public parts: 0 where a pair carries, <= 0 elsewhere."""
        table = PathTable(
            s=np.linspace(5e-3, 36e-3, 7), added=1e-6 * np.array([-9, 3, 0, 4, -2, 1, -8.0])
        )
        phase = np.arange(40) / 40
        load = 3e3
        mesh = solve_mesh(PAIR, load, phase, deviations=[table], model=CLAMPED)
        point, count = mesh.points.point, mesh.force.shape[-1]
        gap = point.gap + table.gap(mesh.points.contacts)
        t1, t2 = point.pinion / PAIR.pinion.base_radius, point.wheel / PAIR.wheel.base_radius
        reduced = point.pinion * point.wheel / (point.pinion + point.wheel)
        e_star = 206e9 / (2 * 0.91)
        loaded = 0
        for p in range(phase.size):
            normal = mesh.force[p] / point.lever[p]
            wide = 4 * normal / (np.pi * WIDTH * e_star)
            for j in range(count):
                if not np.isfinite(gap[p, j]):
                    assert mesh.force[p, j] == 0.0
                    continue
                closing, half = 0.0, 1.0
                if normal[j] > 0.0:
                    edge = (point.rounding[p, j], point.angle[p, j], point.distance[p, j])
                    half = _half_width(wide[j], reduced[p, j], *edge)[0]
                for gear, t, sign in ((PAIR.pinion, t1, -1), (PAIR.wheel, t2, 1)):
                    own = flank_point(gear, t[p, j])
                    closing += normal[j] * float(tooth_compliances(gear, t[p, j]).total)
                    closing += float(
                        weber_approach(
                            normal[j],
                            depth=own.x / np.cos(own.beta),
                            half_width=half,
                            modulus=206e9,
                            poisson=0.3,
                            face_width=WIDTH,
                        )
                    )
                    for k in range(count):
                        if mesh.force[p, k] > 0.0:
                            closing += normal[k] * float(
                                ring_compliance(
                                    gear, t[p, j], other=t[p, k], pitches=sign * (j - k)
                                )
                            )
                # the pinion closes a gap by its lever
                closing = gap[p, j] + closing / point.lever[p, j]
                if mesh.force[p, j] > 0.0:
                    loaded += 1
                    assert closing == pytest.approx(float(mesh.deflection[p]), rel=1e-9)
                else:
                    assert closing >= mesh.deflection[p] * (1 - 1e-9)
        assert loaded > phase.size

    def test_tangent_stiffness_is_the_slope_of_load_over_error(self, compared: Compared) -> None:
        h = 1e-5
        loads = 4e3 * np.array([1 - h, 1.0, 1 + h])
        mesh = solve_mesh(PAIR, loads, np.arange(33) / 33)
        slope = 2 * h * 4e3 / (mesh.deflection[2] - mesh.deflection[0])
        same = np.all((mesh.force > 0) == (mesh.force[1] > 0), axis=(0, 2))
        assert same.sum() >= 31
        compared(
            "tangent stiffness",
            "difference quotient of load over transmission error",
            mesh.tangent[1][same] / slope[same] - 1.0,
            1e-6,
        )

    def test_linear_uncoupled_contact_has_a_closed_form(self, compared: Compared) -> None:
        """Springs side by side: k = k1 + k2, shares as the stiffnesses, secant = tangent."""
        mesh = solve_mesh(PAIR, 4e3, np.array([0.2, 0.8]), model=UNCOUPLED_LINEAR)
        k = np.zeros((2, 4))
        point = mesh.points.point
        for gear, rho in ((PAIR.pinion, point.pinion), (PAIR.wheel, point.wheel)):
            t = np.where(np.isfinite(point.gap), rho / gear.base_radius, 0.36)
            k += tooth_compliances(gear, t).total + ring_compliance(gear, t)
        k = np.where(np.isfinite(point.gap), 1.0 / (k + 1.0 / 3.555868607909e9), 0.0)
        compared(
            "linear uncoupled mesh stiffness",
            "springs side by side in closed form",
            mesh.tangent / k.sum(axis=-1) - 1.0,
            1e-9,
        )
        assert mesh.secant == pytest.approx(mesh.tangent, rel=1e-11)
        assert mesh.share == pytest.approx(k / k.sum(axis=-1, keepdims=True), abs=1e-9)

    def test_how_far_the_contact_laws_are_apart(self) -> None:
        """At 200 N/mm the linear law, which forgets the depth of the tooth, is 12 % too stiff."""
        k = {
            law: float(
                per_width(loaded_contact(PAIR, 200e3 * WIDTH, 50, model=model).mean_stiffness)
            )
            for law in CONTACT_LAWS
            for model in [replace(CLAMPED, contact=law)]
        }
        assert k["yang-sun"] / k["weber-banaschek"] == pytest.approx(1.12, abs=0.01)
        assert k["palmgren"] / k["weber-banaschek"] == pytest.approx(1.0, abs=0.08)

    def test_uncoupled_bodies_are_too_stiff(self) -> None:
        """Two teeth on one body lean on each other: without that +20 % in double contact."""
        phase = np.array([0.3, 0.85])
        loose = solve_mesh(PAIR, 4e3, phase, model=replace(IN_PATH, coupled=False))
        coupled = solve_mesh(PAIR, 4e3, phase, model=IN_PATH)
        assert loose.tangent[0] > 1.15 * coupled.tangent[0]
        assert loose.tangent[1] == pytest.approx(coupled.tangent[1], rel=1e-12)


class TestInvariances:
    def test_constant_shift_of_the_flanks_moves_only_the_error(self, compared: Compared) -> None:
        shift = PathTable(s=[0.0, 0.1], added=[60e-6, 60e-6])
        plain = solve_mesh(PAIR, 4e3, np.arange(100) / 100)
        moved = solve_mesh(PAIR, 4e3, np.arange(100) / 100, deviations=[shift])
        compared(
            "stiffness after shifting every flank by 60 µm",
            "the stiffness before",
            moved.tangent / plain.tangent - 1.0,
            1e-12,
        )
        assert np.abs(moved.secant / plain.secant - 1.0).max() < 1e-9
        assert np.abs(moved.share - plain.share).max() < 1e-12
        assert np.allclose(moved.deflection, plain.deflection - 60e-6, rtol=0, atol=1e-18 + 1e-17)

    def test_swapped_gears_run_backwards(self) -> None:
        pair = GearPair(
            Gear(21, 3e-3, profile_shift=0.3, face_width=15e-3),
            Gear(50, 3e-3, profile_shift=-0.1, face_width=12e-3, bore_radius=40e-3),
        )
        phase = np.linspace(0.013, 0.987, 60)
        hot = 2e-4
        one = solve_mesh(pair, 2e3, phase, deviations=[BasePitchDifference(hot)])
        two = solve_mesh(
            pair.swapped(), 2e3, pair.contact_ratio - phase, deviations=[BasePitchDifference(-hot)]
        )
        edges = (one.edge > 0).any(axis=-1) | (two.edge > 0).any(axis=-1)
        assert 0 < edges.sum() < 20
        assert np.allclose(one.tangent[~edges], two.tangent[~edges], rtol=1e-9)
        assert np.allclose(one.deflection[~edges], two.deflection[~edges], rtol=0, atol=1e-15)
        # on an edge the torque of the pinion is given, of the wheel after the exchange
        lever = one.points.point.lever[one.force > 0.0].min()
        assert np.abs(one.deflection / two.deflection - 1.0)[edges].max() < 1.0 - lever

    def test_the_module_is_only_a_scale(self) -> None:
        small = GearPair(Gear(25, 1e-3), Gear(75, 1e-3))
        large = GearPair(Gear(25, 8e-3), Gear(75, 8e-3))
        phase = np.arange(40) / 40
        one = solve_mesh(small, 1e3, phase)
        two = solve_mesh(large, 64e3, phase)
        assert np.allclose(two.tangent, 8.0 * one.tangent, rtol=1e-9)
        assert np.allclose(two.deflection, 8.0 * one.deflection, rtol=1e-9)
        assert np.array_equal(one.edge, two.edge)
        assert np.allclose(one.pressure, two.pressure, rtol=1e-9, equal_nan=True)

    def test_moduli_scale_the_stiffness(self) -> None:
        """Half the modulus at half the load: the same deflection."""
        half = Moduli(tooth=103e9, body=103e9)
        phase = np.arange(40) / 40
        one = solve_mesh(PAIR, 4e3, phase)
        two = solve_mesh(PAIR, 2e3, phase, pinion=half, wheel=half)
        assert np.allclose(one.tangent, 2.0 * two.tangent, rtol=1e-10)
        assert np.allclose(one.deflection, two.deflection, rtol=1e-11)

    def test_batch_is_one_by_one(self) -> None:
        loads = np.array([1e3, 4e3, 16e3])
        warm = Moduli(tooth=np.array([[206e9], [195e9]]), body=np.array([[206e9], [200e9]]))
        slope = BasePitchDifference(np.array([0.0, 1e-4, 3e-4]))
        phase = np.arange(25) / 25
        every = loaded_contact(PAIR, loads, phase, pinion=warm, deviations=[slope])
        assert every.tangent_stiffness.dims == ("temperature", "load", "mesh_phase")
        for i, j in itertools.product(range(2), range(3)):
            one = loaded_contact(
                PAIR,
                loads[j],
                phase,
                pinion=Moduli(tooth=float(warm.tooth[i, 0]), body=float(warm.body[i, 0])),  # type: ignore[index]
                deviations=[BasePitchDifference(float(slope.strain[j]))],  # type: ignore[index]
            )
            for name in ("tangent_stiffness", "transmission_error", "load_share", "pair_force"):
                assert np.array_equal(every[name].to_numpy()[i, j], one[name].to_numpy())

    def test_back_flanks_of_perfect_gears(self) -> None:
        """A back flank at s^c is as stiff as a drive flank there."""
        pair = GearPair(Gear(25, 5e-3, profile_shift=0.2), Gear(60, 5e-3), centre_distance=213.9e-3)
        phase = np.array([0.05, 0.4, 0.77])
        s = pair.path.a + phase * pair.base_pitch
        there = (back_flank_position(pair, s) - pair.path.a) / pair.base_pitch
        back = solve_mesh(pair, 4e3, phase, flank="back")
        drive = solve_mesh(pair, 4e3, there)
        assert np.allclose(back.tangent, drive.tangent, rtol=1e-9)

    def test_a_period_later_all_is_the_same(self) -> None:
        phase = np.array([0.1, 0.6])
        one, two = solve_mesh(PAIR, 4e3, phase), solve_mesh(PAIR, 4e3, phase + 7.0)
        assert np.allclose(one.tangent, two.tangent, rtol=1e-9)


class TestEdges:
    def test_zero_load(self) -> None:
        got = loaded_contact(PAIR, np.array([0.0, 20.0]), 20)
        assert np.array_equal(got.pair_force[0], np.zeros((20, 4)))
        assert np.array_equal(got.contact_pressure[0], np.zeros((20, 4)))
        assert np.array_equal(got.transmission_error[0], got.unloaded_error[0])
        # stiffness and shares are those at 1 N/mm
        assert np.array_equal(got.tangent_stiffness[0], got.tangent_stiffness[1])
        assert np.array_equal(got.load_share[0], got.load_share[1])

    @pytest.mark.parametrize("load", [1e-6, 1.0, 1e7])
    def test_any_load_settles(self, load: float) -> None:
        mesh = solve_mesh(PAIR, load, np.arange(400) / 400)
        assert np.all(mesh.settled)

    def test_high_contact_ratio_and_undercut(self) -> None:
        from thermogear.gears.geometry import Rack

        rack = Rack(addendum=1.25, dedendum=1.5, fillet_radius=0.25)
        high = GearPair(Gear(60, 2e-3, rack=rack), Gear(70, 2e-3, rack=rack))
        assert high.contact_ratio > 2.0
        mesh = solve_mesh(high, 5e3, np.arange(100) / 100)
        assert np.all(mesh.settled)
        assert (mesh.force > 0).sum(axis=-1).min() >= 2

    def test_refusals(self) -> None:
        with pytest.raises(InputError, match=r"normal_force: got -1\.0 N; allowed >= 0, finite"):
            loaded_contact(PAIR, -1.0)
        with pytest.raises(InputError, match="phase: got 0; allowed one position or more"):
            loaded_contact(PAIR, 1.0, 0)
        with pytest.raises(InputError, match=r"flank: got 'bak'; allowed drive \| back; did you"):
            loaded_contact(PAIR, 1.0, flank="bak")
        with pytest.raises(InputError, match=r"loaded\.body: got 'hub'; .*known: bore_clamped"):
            LoadedModel(body="hub")
        with pytest.raises(InputError, match=r"dimensions: got .*allowed 1 names"):
            loaded_contact(PAIR, [1.0, 2.0], dimensions=("a", "b"))

    def test_dataset_says_units_and_choices(self) -> None:
        got = loaded_contact(PAIR, [1e3], 4)
        assert got.tangent_stiffness.attrs["units"] == "N/m"
        assert all("long_name" in v.attrs for v in got.variables.values())
        assert got.attrs["body"] == "rim"
        assert int(got.status.max()) == 0


class TestOverTheLoad:
    def test_first_touch_is_of_flanks_as_they_are(self) -> None:
        """Averaged over the mean load they are only under load."""
        phase = np.array([0.05, 0.3, 0.55])
        relief = [Relief(gear, amount=15e-6, length=5e-3) for gear in ("pinion", "wheel")]
        loads = np.array([0.0, 3e3, 5e3])
        mesh = solve_mesh(PAIR, loads, phase, deviations=relief, mean_load=4e3)
        touch = first_touch(mesh.points, relief).gap.min(axis=-1)
        assert np.array_equal(mesh.unloaded, np.broadcast_to(touch, (3, 3)))
        assert np.array_equal(mesh.deflection[0], touch)

    def test_many_loads_have_their_averages_from_a_few(self) -> None:
        phase = np.arange(12) / 12
        relief = [Relief(gear, amount=15e-6, length=5e-3) for gear in ("pinion", "wheel")]
        loads = 1e3 * np.array([0.2, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0])
        together = solve_mesh(PAIR, loads, phase, deviations=relief)
        for load, deflection in zip(loads, together.deflection, strict=True):
            alone = solve_mesh(PAIR, load, phase, deviations=relief).deflection
            np.testing.assert_allclose(deflection, alone, rtol=0, atol=1e-8)

    def test_how_far_one_spring_is_from_the_loaded_contact(self) -> None:
        """F = k_t (y - e_0), tangent at the mean load: near it where the loaded set stays.

        At half load it misses by 0.5 % of the mean load in the median, and by 15 % where a tip
        corner has let go meanwhile (phase 0.94); at a tenth of the load by 2 % and 32 %.
        """
        model, phase = LoadedModel(body="rim"), np.arange(100) / 100
        mesh = solve_mesh(PAIR, 4e3, phase, model=model)
        for part, median, worst in ((0.9, 1.5e-4, 1.1e-3), (0.5, 4.5e-3, 0.15), (0.1, 0.02, 0.32)):
            other = solve_mesh(PAIR, part * 4e3, phase, model=model)
            spring = 4e3 + mesh.tangent * (other.deflection - mesh.deflection)
            apart = np.abs(spring - part * 4e3) / 4e3
            assert np.median(apart) == pytest.approx(median, rel=0.05)
            assert apart.max() == pytest.approx(worst, rel=0.05)
            same = np.all((mesh.force > 0) == (other.force > 0), axis=-1)
            # at nine tenths what is left is a corner's narrowing contact, 0.1 % of the load
            assert apart[same].max() < (8.0 if part == 0.9 else 2.0) * np.median(apart)
            assert part == 0.9 or not same[np.argmax(apart)]
