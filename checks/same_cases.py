"""Small cases of every command: for ``checks/same.py``."""

from __future__ import annotations

import io
import wave
from collections.abc import Mapping
from dataclasses import dataclass, field
from shlex import quote

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Case:
    """Commands carried out one after another in a folder of their own.

    ``steps``: words after ``thermogear``, as a shell splits them, or ``-c`` and a line of Python.
    ``files``: what stands in the folder beforehand. ``before``: the steps of the reference, where
    its words were others.
    """

    name: str
    steps: tuple[str, ...]
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    before: tuple[str, ...] | None = None


# --- what stands in the folders ----------------------------------------------------------------

OWN = """\
title = "A pair of no thesis"
kind = "gear"

[gears]
module = "2.5 mm"
pressure_angle = "20 deg"
centre_distance = "107.1 mm"

[gears.rack]
addendum = 1.0
dedendum = 1.25
fillet_radius = 0.3

[gears.pinion]
teeth = 28
profile_shift = 0.2
face_width = "22 mm"
bore_radius = "15 mm"
material = "mine"
roughness = "0.5 um"
tip_relief = { amount = "12 um", length = "2 mm", shape = "parabolic", flank = "drive" }
pressure_angle_error = "0.01 deg"

[gears.wheel]
teeth = 57
profile_shift = 0.1
tip_diameter = "147.8 mm"
face_width = "20 mm"
bore_radius = "25 mm"
material = "steel"
roughness = "0.4 um"
root_relief = { amount = "6 um", length = "1.5 mm" }
profile = { radius = ["70 mm", "71 mm", "72 mm"], added = ["0 um", "-2 um", "-3 um"] }

[materials.mine]
youngs_modulus = "200 GPa"
poisson_ratio = 0.29
density = "7700 kg/m^3"
thermal_conductivity = "40 W/(m K)"
specific_heat = "460 J/(kg K)"
thermal_expansion = "1.2e-5 1/K"
modulus_slope = "3e-4 1/K"
tempering_temperature = "200 degC"

[housing]
material = "steel"

[oil]
name = "own"
viscosity_40 = "100 mm^2/s"
viscosity_100 = "11 mm^2/s"
density_15 = "885 kg/m^3"
scuffing_load_stage = 10

[inertia]
model = "given"
pinion = "1.5e-3 kg m^2"
wheel = "2e-2 kg m^2"

[operating]
speed = ["1500 rpm", "6000 rpm"]
torque = ["30 N m", "60 N m"]

[temperatures]
reference = "20 degC"

[gearbox]
housing_area = "0.4 m^2"
wetted_share = [0.3, 0.4]
oil_flow = "1 l/min"

[gearbox.measured]
housing = "55 degC"

[gearbox.readings.oil]
kind = "infrared"
indicated = "60 degC"
indicated_uncertainty = "1 K"
emissivity = 0.95
emissivity_uncertainty = 0.02
surroundings = "30 degC"

[sensors.thermocouple]
gear = "wheel"
depth = "1 mm"

[sensors.infrared]
emissivity = 0.85
wavelengths = ["3 um", "5 um"]

[backlash.tolerances]
pinion_tooth_thickness = ["-0.06 mm", "-0.04 mm"]
wheel_tooth_thickness = ["-0.07 mm", "-0.05 mm"]
centre_distance = ["-0.01 mm", "0.02 mm"]

[dynamics]
damping_ratio = 0.05

[transmission_error]
harmonics = [
  { order = 1, amplitude = "4 um", phase = "30 deg" },
  { order = 2, amplitude = "1 um" },
]

[model]
bundle = "consistent"

[grid]
path_positions = 41
mesh_positions = 48
harmonics = 12

[simulation]
periods = 16
discard = 40
most_discarded = 400
steps_per_period = 128
samples = 32
sample_periods = 2
"""
"""Everything a case may say that the rig does not; its temperatures come from the heat balance."""

DUTY = """\
time [min],speed [rpm],torque [N m],ambient [degC]
0,3000,100,20
6,1500,150,20
10,0,0,10
13,0,0,10
"""
WARMED = """\
time [min],pinion_tooth [degC],oil [degC],infrared [degC]
2,26.1,24.3,
5,33.9,29.8,33.1
8,44.0,38.2,42.5
12,49.2,43.9,
"""
LINES = """\
speed [rpm],frequency [Hz],displacement [um],uncertainty [%]
1500,700.2,1.1,5
6000,2799.1,2.3,4
"""
RATE = 12_000
TEETH = 25


def _record() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Time [s] and acceleration [m/s^2] of a pinion of 25 teeth at 1000 rpm, with noise."""
    t = np.arange(8_000) / RATE
    turns = 2.0 * np.pi * 1000.0 / 60.0 * t
    swing = 1.0 + 0.2 * np.cos(turns) + 0.1 * np.cos(2.0 * turns)
    peak = 10e-6 * (TEETH * 2.0 * np.pi * 1000.0 / 60.0) ** 2
    made = peak * swing * (np.cos(TEETH * turns) + 0.4 * np.cos(2 * TEETH * turns))
    return t, made + 0.5 * np.random.default_rng(2).standard_normal(t.size)


def _table(gain: float = 1.0) -> str:
    rows = "".join(f"{t:.9g},{gain * a:.9g}\n" for t, a in zip(*_record(), strict=True))
    return f"time [s],acc [m/s^2]\n{rows}"


def _bare() -> str:
    """Without a time column, with decimal commas."""
    rows = "".join(f"{a:.9g}\n" for a in _record()[1])
    return f"housing\n{rows}".replace(".", ",")


def _sound() -> bytes:
    """The same as 16-bit samples of 200 m/s^2 at full scale."""
    stream = io.BytesIO()
    with wave.open(stream, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(np.round(_record()[1] / 200.0 * 32767.0).astype("<i2").tobytes())
    return stream.getvalue()


RECORDS = """
import h5py, numpy as np, scipy.io
time, acc = np.loadtxt("record.csv", delimiter=",", skiprows=1, unpack=True)
tacho = 5.0 * (np.mod(1000.0 / 60.0 * time, 1.0) < 0.5)
np.savez("record.npz", acc=acc)
scipy.io.savemat("record.mat", {"acc": acc, "fs": 12000.0})
with h5py.File("record.h5", "w") as file:
    file["acc"] = acc
rows = np.column_stack([time, acc, tacho])
heads = "time [s],acc [m/s^2],tacho [V]"
np.savetxt("record-tacho.csv", rows, "%.9g", ",", header=heads, comments="")
"""
"""The record in other formats; some of them carry a date."""

LIBRARY = """
import numpy as np, xarray as xr
from thermogear import (
    Gear, GearPair, PairModel, Periodic, TorsionalModel, excitation, heat_balance, lubricant,
    mesh_cycle, simulate,
)
numbers = dict(damping_ratio=0.12, stiffness_amplitude=0.335, mean_force=0.017,
               force_amplitude=-1.16)
one = TorsionalModel(frequency=1.245, **numbers)
lanes = TorsionalModel(frequency=np.linspace(1.1, 1.3, 9), **numbers)
pair = GearPair(
    Gear(28, 2.5e-3, profile_shift=0.2, face_width=22e-3, bore_radius=15e-3),
    Gear(57, 2.5e-3, profile_shift=0.1, face_width=22e-3, bore_radius=25e-3),
    centre_distance=107.1e-3,
)
balance = heat_balance(
    pair, np.array([100.0, 500.0]), 60.0, lubricant("M100"), half_backlash=pair.normal_backlash / 2
)
cycle = mesh_cycle(pair, balance.operating, mesh_positions=48)
inputs = excitation(cycle, pair, damping_ratio=0.05, transmission_error=Periodic(0.0, (4e-6,)))
few = dict(periods=8, samples_per_period=16)
found = {
    "exact": simulate(lanes, method="exact", **few),
    "rk4": simulate(lanes, method="rk4", steps_per_period=64, **few),
    "single": simulate(lanes, method="rk4", steps_per_period=64, precision="float32", **few),
    "adaptive": simulate(one, method="adaptive", **few),
    "gears": simulate(PairModel.from_excitation(inputs[1]), **few),
    "cycle": cycle,
}
xr.DataTree.from_dict(found).to_netcdf("found.nc", engine="h5netcdf")
"""
"""What no command reaches: other ways to integrate, both gears' angles."""

# --- the cases -----------------------------------------------------------------------------------

FEW = (
    "--set grid.mesh_positions=48 --set grid.harmonics=12 --set grid.path_positions=41 "
    "--set simulation.periods=16 --set simulation.discard=40 --set simulation.most_discarded=400 "
    "--set simulation.steps_per_period=128 --set simulation.samples=32 "
    "--set simulation.sample_periods=2"
)
"""The rig's grids made small."""
BARE = f"""{FEW} --set 'draw.base_sets=[]'"""
SHORT = f"""{BARE} --set 'operating.speed="3000 rpm"' --set 'temperatures.row=[]'"""
ONE_BUNDLE = f"{SHORT} --set model.bundle=consistent"
MOTION = f"""{ONE_BUNDLE} --set 'draw.pictures=["motion"]'"""
NUMBERS = "--zeta 0.1535 --w 1.245 --eps 0.335 --fm 0.017 --fh -1.16"
CHOICES = (
    "friction=dry inlet=oil flash=blok heat_distribution=uniform bore=rigid spring=secant "
    "body=bore-clamped sharing=stiffness",
    "friction=xu-kahraman flash=blok flank=thesis bore=shaft modulus=constant "
    "stiffness=textbook-30-degree thermal_stiffness=thesis housing=rigid",
    "friction=fernandes flash=blok heat_distribution=parabola inlet=oil sharing=equal",
)
COMMANDS = [
    *("new", "import", "draw", "answers", "run", "report", "check", "example", "schema"),
    *("friction", "temperature", "warmup", "relief", "contact"),
    *("statics", "modes", "campbell", "waterfall"),
    *("orbit", "lyapunov", "continue"),
    *("bifurcation", "map", "basins", "runup", "sweep"),
    *("measure", "compare", "detect", "diagnose", "thesis", "sensitivity", "versus"),
]
SMALL_THESIS = (
    "-c 'from pathlib import Path; from thermogear.thesis import report; "
    "from thermogear.thesis.evidence import Size; "
    "size = Size(speeds=2, torques=2, diagram=21, flips=2, samples=8); "
    'old = getattr(report, "build_to_directory", None); '
    'old(Path("out"), size) if old else report.build(size).write("out")\''
)
PITCH = str([f"{3 * (n * n % 7) - 9} um" for n in range(TEETH)]).replace("'", '"')


def _gearbox() -> str:
    """A REXS model of one spur stage, 21:43 teeth, 1450 rpm and 30 N m."""
    both = {"normal_module": ("mm", 2.5), "face_width": ("mm", 20.0)}
    parts: dict[tuple[int, str], dict[str, tuple[str, float]]] = {
        (1, "cylindrical_stage"): {"center_distance": ("mm", 80.9)},
        (2, "shaft"): {"rotational_speed": ("1 / min", 1450.0)},
        (3, "shaft"): {},
        (4, "external_load"): {"torque_around_u_axis": ("N m", 30.0)},
        (5, "cylindrical_gear"): {"number_of_teeth": ("none", 21), **both},
        (6, "cylindrical_gear"): {"number_of_teeth": ("none", 43), **both},
    }
    components = "".join(
        f'<component id="{ident}" type="{kind}">'
        + "".join(
            f'<attribute id="{name}" unit="{unit}">{value}</attribute>'
            for name, (unit, value) in sizes.items()
        )
        + "</component>"
        for (ident, kind), sizes in parts.items()
    )
    links = {
        "stage": [{"stage": 1, "gear_1": 5, "gear_2": 6}],
        "assembly": [{"assembly": whole, "part": part} for whole, part in ((2, 5), (3, 6), (2, 4))],
    }
    relations = "".join(
        f'<relation id="{number}" type="{kind}">'
        + "".join(f'<ref id="{ident}" role="{role}"/>' for role, ident in roles.items())
        + "</relation>"
        for number, (kind, roles) in enumerate(
            (kind, roles) for kind, several in links.items() for roles in several
        )
    )
    return (
        f'<model version="1.7" applicationId="same"><relations>{relations}</relations>'
        f"<components>{components}</components></model>"
    )


MINE = {"own.toml": OWN}


def _set(words: str) -> str:
    return " ".join(f"--set model.{word}" for word in words.split())


CASES = (
    Case("help", ("--help", *(f"{name} --help" for name in COMMANDS))),
    Case(
        "example", ("example", "example rig", "example table-4.2", "example section-4.1 -o a.toml")
    ),
    Case("schema", ("schema", "schema -o schema.json")),
    Case(
        "new",
        (
            "new --teeth 20 40 --module '3 mm' --face-width '30 mm' --torque '80 N m' "
            "--speed '3000 rpm' -o five.toml",
            "check five.toml",
            "answers five.toml -o answers",
        ),
    ),
    Case(
        "third-pair",
        (
            "new --teeth 23 71 --module '1.5 mm' --face-width '14 mm' --torque '12 N m' "
            "--speed '6000 rpm' -o third.toml",
            f"run third.toml -o run --json {FEW}",
            "temperature third.toml -o temperature --own --json",
            "friction third.toml -o friction --json",
            "contact third.toml -o contact --torques 6,12 --json",
        ),
    ),
    Case(
        "rexs",
        (
            "import own.rexs",
            "import own.rexs --stage 1 -o again.toml",
            "check again.toml --json",
        ),
        {"own.rexs": _gearbox()},
    ),
    Case(
        "check",
        (
            "check rig --json",
            "check rig --set 'gears.pinion.teeth=30' --set 'gears.wheel.profile_shift=0.1'"
            " --set 'gears.pinion.tip_diameter=\"160 mm\"'",
            "check own.toml --json",
            "check table-4.2 --json",
        ),
        MINE,
    ),
    # --- runs
    Case(
        "run-rig",
        (
            f"""run rig -o out --json {FEW} --set 'draw.base_sets=["section-4.1"]' """
            """--set 'operating.speed=["1000 rpm","8000 rpm"]' """
            """--set 'operating.torque="40 N m"'""",
        ),
    ),
    Case(
        "run-row",
        (
            f"run rig -o out --json {ONE_BUNDLE} --set temperatures.follow=fixed "
            """--set 'gears.pinion.teeth=30' --set 'gears.pinion.tip_diameter="160 mm"' """
            """--set 'temperatures.row=["60 degC","120 degC"]'""",
        ),
    ),
    Case("run-own", ("run own.toml -o out --json --set model.bundle=both",), MINE),
    Case(
        "run-pitch",
        (f"run rig -o out --json {ONE_BUNDLE} --set 'gears.pinion.pitch_errors={PITCH}'",),
    ),
    *(
        Case(f"run-choices-{number}", (f"run rig -o out --json {ONE_BUNDLE} {_set(words)}",))
        for number, words in enumerate(CHOICES, start=1)
    ),
    Case("run-table", ("run table-4.2 -o out --json",)),
    Case(
        "report",
        (
            f"run rig -o out {ONE_BUNDLE}",
            "report out --pictures pictures --kind svg",
        ),
    ),
    Case(
        "versus",
        (
            f"run rig -o one {MOTION}",
            f"run rig -o two {MOTION} --set 'operating.torque=150 N m'",
            "versus one two -o out --json",
        ),
    ),
    # --- one motion
    Case("orbit-table", ("orbit table-4.2 --row zeta --point 2 -o out --json",)),
    Case(
        "orbit-numbers",
        (
            f"orbit {NUMBERS} --period 2 -o out --json",
            f"orbit {NUMBERS} --b 0.9 --eps-t 0.01 --period 1 --direct --start 0.2,0.1 -o direct",
        ),
    ),
    Case(
        "orbit-gear",
        (
            "orbit rig --operating 2 -o out --json",
            "orbit own.toml --operating 3 --state undeformed -o own --json",
        ),
        MINE,
    ),
    Case(
        "lyapunov",
        (
            "lyapunov table-4.2 --row zeta --point 4 --discard 200 --batches 4 --batch-periods 50"
            " -o out --json",
            "lyapunov rig --discard 50 --batches 4 --batch-periods 20 -o gear --json",
        ),
    ),
    Case("continue-speed", ("continue rig --parameter speed --to '4000 rpm' -o out --json",)),
    Case(
        "continue-torque",
        ("continue rig --parameter torque --to '97 N m' --operating 3 -o out --json",),
    ),
    Case(
        "continue-temperature",
        (
            "continue rig --parameter temperature --from '120 degC' --to '100 degC' --operating 3"
            " --bundle thesis -o out --json",
        ),
    ),
    Case(
        "continue-numbers",
        (
            "continue --zeta 0.18 --w 1.245 --eps 0.335 --fm 0.017 --fh -1.16 --parameter zeta"
            " --to 0.12 --switch 2 -o out --json",
        ),
    ),
    # --- stores
    Case(
        "bifurcation-table",
        ("bifurcation table-4.2 --over zeta=0.1:0.18:9 --start 0,0 --start 0.5,0.1 -o out --json",),
    ),
    Case(
        "bifurcation-gear",
        ("bifurcation rig --over rpm=6000:9000:7 --branch-period 1 -o out --json --threads 1",),
    ),
    Case(
        "bifurcation-undeformed",
        (
            "bifurcation rig --over torque=60:100:3 --state undeformed --branch-period 1"
            " -o out --json",
            "bifurcation table-4.2 --over omega=1.1:1.3:5 --but b=0.9 --branch-period 2 -o rows",
        ),
    ),
    Case(
        "map-gear",
        (
            "map rig --over rpm=2000:9000:6 --over torque=50:200:4 -o out --json",
            "map own.toml --over temperature=40:100:3 --over backlash=40:80:3 --full -o own --json",
        ),
        MINE,
    ),
    Case(
        "map-table",
        (
            "map table-4.2 --over zeta=0.1:0.18:12 --over omega=1.1:1.3:12 --but b=0.9 -o out"
            " --json --threads 2",
        ),
    ),
    Case(
        "basins",
        (
            "basins table-4.2 --but zeta=0.12 --x -2:2:21 --v -2:2:21 -o out --json",
            "basins rig --x -2:2:9 --v -2:2:9 -o gear --json",
        ),
    ),
    Case(
        "runup",
        (
            "runup rig --rpm 6000:8000:3 --hot 100 --torque 60 --bundle thesis -o out --json"
            " --threads 1",
            "runup own.toml --rpm 3000:6000:2 --branch-period 0 -o own --json",
        ),
        MINE,
    ),
    Case(
        "sweep",
        (
            "sweep rig --over rpm=2000:9000:5 --over temperature=20,140 -o out --json",
            "sweep rig --over 'gears.pinion.face_width=20 mm:30 mm:3' --over damping=0.03,0.1"
            " --bundle thesis -o wide --json",
        ),
    ),
    # --- surveys
    Case("friction", ("friction rig -o out --json", "friction own.toml -o own --json"), MINE),
    Case(
        "temperature",
        (
            "temperature rig -o out --speeds 1000,3000 --torques 100:200:2 --json",
            "temperature own.toml -o own --own --json",
        ),
        MINE,
    ),
    Case(
        "warmup",
        (
            "warmup rig -o out --duty duty.csv --measured warmed.csv --json",
            "warmup own.toml -o own --at 3000,40 --start 30 --json",
        ),
        {**MINE, "duty.csv": DUTY, "warmed.csv": WARMED},
    ),
    Case(
        "relief",
        (
            "relief rig -o out --json",
            "relief own.toml -o own --torque 50 --temperature 80 --shape parabolic --symmetric"
            " --largest 30 --json",
        ),
        MINE,
    ),
    Case(
        "contact",
        (
            "contact rig -o out --torques 50,100 --json",
            "contact own.toml -o own --body rim --json",
        ),
        MINE,
    ),
    Case(
        "draw",
        (
            "draw rig -o gears.svg --operating 2 --json",
            "draw own.toml -o gears.png --phase 0.5 --enlarge 20 --state 80 --show hot --json",
        ),
        MINE,
    ),
    Case(
        "shafts",
        (
            "statics motor-train -o out --json",
            "modes motor-train -o modes --count 6 --json",
            "campbell motor-train -o campbell --rpm 0:4000 --count 6 --json",
            "waterfall motor-train -o waterfall --rpm 2000:2400:3 --seconds 0.5 --json",
        ),
    ),
    # --- records
    Case(
        "measure",
        (
            "measure record.csv --json -o out",
            "measure record.csv --teeth 25 --speed 1000 --method trapezoid -o trapezoid",
            "measure bare.csv --decimal , --rate 12000 --unit m/s^2 --sensor-tolerance 0.03 --json"
            " -o bare",
            "measure record.wav --unit m/s^2 --scale 200 --method line --json -o sound",
        ),
        {"record.csv": _table(), "bare.csv": _bare(), "record.wav": _sound()},
    ),
    Case(
        "diagnose",
        (
            "diagnose record.csv --teeth 25 --wheel-teeth 75 --speed 1000 --bearing 6205"
            " --baseline louder.csv -o out --json",
            "diagnose record.csv --teeth 25 --speed 1000",
        ),
        {"record.csv": _table(), "louder.csv": _table(gain=1.3)},
    ),
    Case(
        "detect",
        (
            "detect rig --parts 8 --set model.bundle=consistent --set flanks.accuracy=6"
            " --set 'operating.speed=\"2000 rpm\"' --set 'operating.torque=\"150 N m\"'"
            ' --set \'faults=[{kind = "missing", gear = "pinion"}]\' -o out --json',
        ),
    ),
    Case(
        "measure-formats",
        (
            f"-c {quote(RECORDS)}",
            "measure record.npz --rate 12000 --unit m/s^2 --json -o npz",
            "measure record.mat --rate 12000 --unit m/s^2 --json -o mat",
            "measure record.h5 --rate 12000 --unit m/s^2 --json -o hdf",
            "measure record-tacho.csv --tacho tacho --pulses 1 --json -o tacho",
        ),
        {"record.csv": _table()},
    ),
    Case(
        "compare",
        (
            "compare thesis-5.2 -o out --json",
            "compare own.toml lines.csv --tolerance dynamics.damping_ratio=10"
            " --samples 2 --teeth 28 -o own --json",
            f"run rig -o run {MOTION} --set 'operating.speed=\"1000 rpm\"'",
            "compare run record.csv --speed 1000 --teeth 25 -o record --json",
        ),
        {**MINE, "lines.csv": LINES, "record.csv": _table()},
    ),
    # --- the thesis
    Case("sensitivity", ("sensitivity rig --samples 8 -o out --json",)),
    Case("thesis", (SMALL_THESIS,)),
    Case("library", (f"-c {quote(LIBRARY)}",)),
)
