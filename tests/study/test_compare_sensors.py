"""Accelerometers on a drive train: where they sit decides what they show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from coded import coded
from conftest import Compared
from own_trains import OWN, PAIR, bare, bearing
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.thermal_state import HOT, ThermalState
from thermogear.dynamics.ladder import Engine
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.results.result import Notice
from thermogear.study import compare_sensors as study
from thermogear.study.case_runs import PARTS
from thermogear.study.compare import compare
from thermogear.study.compare_sensors import compare_sensors
from thermogear.study.shafts.motion import Moved, moved
from thermogear.study.shafts.record import SAMPLES
from thermogear.study.shafts.sensed import accelerometer, sensed
from thermogear.study.shafts.state import STATES, plan_of, settled

Floats = NDArray[np.float64]
SPRING = 'ring = { load = "1000 N", deflection = "5 um", play = "2 um" }\ndamping = "0 N s/m"'
HOUSING = """
[train]
elements = 4
[housing]
mass = "40 kg"
mount_stiffness = ["60 N/um", "90 N/um"]
mount_damping = "4000 N s/m"
"""
GRID = "[grid]\nmesh_positions = 64\nharmonics = 8\n"
KNOWN = '[transmission_error]\nharmonics = [{order = 1, amplitude = "3 um"}]\n'
"""Flanks that no class has drawn."""
BOX = PAIR + GRID + KNOWN + bare("pinion") + bare("wheel") + HOUSING
HOUSED = BOX + "".join(
    bearing(shaft, place, SPRING + f'\nname = "{shaft} {side}"')
    for shaft in ("pinion", "wheel")
    for side, place in (("left", "10 mm"), ("right", "100 mm"))
)
AT = ("a1=bearing:pinion left:x", "a2=housing:y", "a3=journal:wheel right:30 deg")
CHANNELS = ("a1", "a2", "a3")
RATE, COUNT = 25_600.0, 1 << 14


def made(text: str) -> Moved:
    """The hot train of a case in motion."""
    case = gear_case(load_case(text))
    ((state,),) = settled(case, [0], states=(HOT,))
    return moved(case, state)


def felt(one: Moved, *at: str) -> Floats:
    """Accelerations (sample, sensor) of accelerometers at the places told."""
    assert one.train is not None
    assert one.motion is not None
    own = one.train.state.assembly
    names = [place.bearing.name for place in own.bearings]
    sensors = [accelerometer(f"c={text}", bearings=names, channels=["c"]) for text in at]
    vectors = np.stack([sensor.vector(own) for sensor in sensors], axis=-1)
    return sensed(one.train, one.motion.state, vectors=vectors)


@dataclass(frozen=True)
class Rig:
    """A train in motion, and the record that three accelerometers on it would give."""

    train: Moved
    measured: Measurement


@pytest.fixture(scope="module")
def rig() -> Rig:
    one = made(HOUSED)
    assert one.train is not None
    heard = felt(one, *(text.partition("=")[2] for text in AT))
    waves = np.fft.rfft(heard, axis=0) * (2.0 / heard.shape[0])
    time = np.arange(COUNT) / RATE
    periods = heard.shape[0] // SAMPLES
    values = np.zeros((COUNT, heard.shape[1]))
    for rank in range(1, waves.shape[0] - 1):
        frequency = rank * one.train.model.mesh_frequency / periods
        if frequency < 0.45 * RATE:
            turn = np.exp(2j * np.pi * frequency * time)
            values += (turn[:, None] * waves[rank]).real
    noise = np.random.default_rng(11).standard_normal(values.shape)
    values += 0.02 * values.std(axis=0) * noise
    channels = tuple(
        Channel(name, column, "m/s^2") for name, column in zip(CHANNELS, values.T, strict=True)
    )
    record = Record(channels, "synthetic", RATE, "stated")
    return Rig(one, measure(record, teeth=20, speed=3000.0 * np.pi / 30.0))


def test_a_synthetic_record_comes_back_at_its_places(rig: Rig) -> None:
    found = compare_sensors(HOUSED, rig.measured, AT)
    assert [row.where.partition(":")[0] for row in found.rows[::3]] == list(CHANNELS)
    hot = found.models.index("hot")
    for row in found.rows:
        assert row.quantity == "acceleration"
        assert abs(row.errors[hot]) <= 3.0 * row.u_val, row
    sure = [row for row in found.rows if row.u_val < 0.01]
    assert len(sure) >= 3
    assert not [one for one in found.notices if one.level == "important"]


def test_of_a_class_a_train_has_the_median_of_its_parts(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Lines of made-up trains: as great as the number of the part makes them."""
    sizes = np.random.default_rng(4).uniform(0.5, 2.0, PARTS)

    def simulated(
        case: GearCase, place: int, speed: float, sensors: Sequence[object], *,
        held: int = 0, only: ThermalState | None = None,
    ) -> tuple[dict[ThermalState, Floats], list[Notice]]:  # fmt: skip
        assert case.file.flanks is not None
        assert case.series == 1
        line = sizes[case.file.flanks.drawing] * np.ones((len(study.ORDERS), len(sensors)))
        return dict.fromkeys(STATES if only is None else (only,), line), []

    monkeypatch.setattr(study, "_simulated", simulated)
    found = compare_sensors(HOUSED.replace(KNOWN, ""), rig.measured, AT, u_num=0.0)
    middle = float(np.median(sizes))
    for row in found.rows:
        assert row.simulated == (middle, middle)
        most = np.abs(sizes - middle).max()
        assert row.u_input == pytest.approx(most / row.measured, rel=1e-12)
    assert coded(found.notices)["u_input_of_drawings"] == [{"drawings": PARTS, "accuracy": 6}]


def test_an_exchanged_axis_is_seen_and_said(rig: Rig) -> None:
    wrong = ("a1=bearing:pinion left:y", *AT[1:])
    found = compare_sensors(HOUSED, rig.measured, wrong, u_num=0.002)
    hot = found.models.index("hot")
    rows = [row for row in found.rows if row.where.startswith("a1")]
    strongest = max(rows, key=lambda row: row.measured)
    assert abs(strongest.errors[hot]) > 10.0 * strongest.u_val
    (told,) = coded(found.notices)["axes_exchanged"]
    assert told["channel"] == "a1"
    assert wrong[0].split(":")[1] in told["along"]


def test_an_axis_at_an_angle_shows_the_projection(rig: Rig) -> None:
    for place in ("bearing:pinion left", "housing", "journal:wheel left", "gear:wheel"):
        x, y, between = felt(rig.train, f"{place}:x", f"{place}:y", f"{place}:-37.5").T
        angle = np.radians(-37.5)
        off = between - (np.cos(angle) * x + np.sin(angle) * y)
        assert np.abs(off).max() <= 1e-12 * np.abs(between).max()


def test_a_cap_without_a_seat_moves_as_the_housing(rig: Rig) -> None:
    cap, housing, journal = felt(
        rig.train, "bearing:wheel left:x", "housing:x", "journal:wheel left:x"
    ).T
    assert np.array_equal(cap, housing)
    assert np.abs(journal - housing).max() > 0.1 * np.abs(housing).max()


def test_a_rigid_housing_on_springs_answers_the_bearings_forces(
    rig: Rig, compared: Compared
) -> None:
    """A = -w^2 F/(k - M w^2 + i c w) line by line, F the sum of the forces on the rings."""
    one = rig.train
    assert one.train is not None
    assert one.motion is not None
    model, own = one.train.model, one.train.state.assembly
    run = Engine(model).run(one.motion.state, 16, samples=SAMPLES)
    q = run.samples[:, : model.size]
    force = np.zeros((q.shape[0], 2))
    for place in own.bearings:
        force -= place.bearing.law.force(q @ one.train.reduction.vector(place.directions))
    heard = felt(one, "housing:x", "housing:y")
    line = 2j * np.pi * model.mesh_frequency * np.arange(1, 4)
    order = 16 * np.arange(1, 4)
    push, shown = (np.fft.rfft(v, axis=0)[order] for v in (force, heard))
    springs = np.array([60e6, 90e6])
    closed = line[:, None] ** 2 * push / (springs + (40.0 * line**2 + 4000.0 * line)[:, None])
    compared(
        "lines of an accelerometer on the housing of a drive train, relative",
        "closed form of a mass on springs under the bearings' forces",
        shown / closed - 1.0,
        1e-6,
    )


def test_a_fixed_place_is_refused_with_what_lets_it_move() -> None:
    case = gear_case(load_case(GRID + OWN))
    ((state,),) = settled(case, [0], states=(HOT,))
    names = plan_of(case).bearing_names
    for text in (f"a=bearing:{names[0]}:x", "a=housing:y"):
        one = accelerometer(text, bearings=names, channels=["a"])
        with pytest.raises(InputError, match=r"it would show zero; give housing\.mass and"):
            one.vector(state.assembly)
    shaft = accelerometer(f"a=journal:{names[0]}:x", bearings=names, channels=["a"])
    assert np.any(shaft.vector(state.assembly) != 0.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a1", r"got 'a1'; allowed CHANNEL=PLACE:DIRECTION"),
        ("a1=housing", r"allowed CHANNEL=PLACE:DIRECTION"),
        ("a9=housing:x", r"got channel 'a9'; allowed a1 \| a2; did you mean 'a"),
        ("a1=bering:pinion 1:x", r"got place 'bering'.*did you mean 'bearing'"),
        ("a1=bearing:pinoin 1:x", r"got bearing 'pinoin 1'.*did you mean 'pinion 1'"),
        ("a1=bearing:x", r"bearing lacks name or direction"),
        ("a1=gear:weel:x", r"got gear 'weel'; allowed pinion \| wheel; did you mean 'wheel'"),
        ("a1=housing:z", r"got direction 'z'; allowed x \| y \| -360\.\.360, degrees from x"),
        ("a1=housing:1e9", r"got direction '1e9'"),
        ("a1=housing:nan", r"got direction 'nan'"),
    ],
)
def test_a_wrong_place_is_one_line_with_the_nearest(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as told:
        accelerometer(text, bearings=["pinion 1", "pinion 2"], channels=["a1", "a2"])
    assert "\n" not in str(told.value)


def test_what_has_no_drive_train_or_no_record_is_refused(rig: Rig) -> None:
    with pytest.raises(InputError, match=r"^shafts: got nothing"):
        compare_sensors(PAIR, rig.measured, AT)
    with pytest.raises(InputError, match=r"^--at: got .*stored results and tables do not say"):
        compare("thesis-5.2", rig.measured, at=AT)
    with pytest.raises(InputError, match=r"^--at: got .*a table of lines has no channels"):
        compare(HOUSED, "thesis-5.2", at=AT)
    with pytest.raises(InputError, match=r"channel 'a1' twice"):
        compare_sensors(HOUSED, rig.measured, (AT[0], "a1=housing:y"))
    other = HOUSED.replace('speed = "3000 rpm"', 'speed = "2000 rpm"')
    with pytest.raises(InputError, match=r"^operating\.speed: got 2000 rpm; .*makes 3000"):
        compare_sensors(other, rig.measured, AT)
    record = rig.measured.record
    bare_channels = tuple(replace(one, unit=None) for one in record.channels)
    bare = replace(record, channels=bare_channels)
    unknown = measure(bare, teeth=20, speed=3000.0 * np.pi / 30.0)
    with pytest.raises(InputError, match=r"^channel 'a1': got no unit; allowed an acceleration"):
        compare_sensors(HOUSED, unknown, AT)
