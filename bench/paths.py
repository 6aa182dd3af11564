"""``make bench NAME=paths``: what one answer costs, from a parameter to a figure, before and after.

python bench/paths.py                 this tree beside the reference, both sides in one run
python bench/paths.py --only orbit    some rows
python bench/paths.py --write         and put the table into bench/records/paths.md

Each row is a piece of Python that prepares itself once and then runs a few times; counted is
processor time on one thread, the median of the rounds, the two trees in turn. The reference is
another commit's sources in the same environment.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

ROOT = Path(__file__).parents[1]
REFERENCE = "1cfadf5"
PAGE = ROOT / "bench" / "records" / "paths.md"

HEAD = """
import json, time, warnings, sys
warnings.simplefilter("ignore")
import numpy as np
from dataclasses import replace
from thermogear.case.case import load_case, load_example
KEPT = {"model.friction": "benedict-kelley"}
RPM = np.pi / 30.0
rng = np.random.default_rng(18)
OWN = '''[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[operating]
speed = "3000 rpm"
torque = "80 N m"
'''
rig = replace(load_example("rig", KEPT), mesh_positions=64)
own = replace(load_case(OWN), mesh_positions=64)
def timed(work, per, times=3):
    work()
    spent = []
    for _ in range(times):
        begun = time.process_time()
        work()
        spent.append((time.process_time() - begun) / per)
    print(json.dumps(1e3 * sorted(spent)[len(spent) // 2]))
NINE = dict(
    cold_backlash=rng.uniform(0.20e-3, 0.30e-3, 512), gear=rng.normal(413.15, 5.0, 512),
    housing=rng.normal(40.0, 8.0, 512), shaft=rng.normal(20.0, 5.0, 512),
    torque=rng.normal(100.0, 2.0, 512), zeta=0.07 * np.exp(0.25 * rng.normal(size=512)),
    error=5e-6 * np.exp(0.2 * rng.normal(size=512)), expansion=rng.uniform(0.97, 1.03, 512),
    stiffness=rng.uniform(0.97, 1.03, 512),
)
"""
NEW = """
from thermogear.case.samples import quasi_static, sampled
from thermogear.case.points import points_of
from thermogear.case.thermal_state import HOT
from thermogear.mesh.excite import EXCITES
steel = '''
[materials.mine]
youngs_modulus = "206 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
thermal_conductivity = "46 W/(m K)"
specific_heat = "470 J/(kg K)"
thermal_expansion = "11.5e-6 1/K"
modulus_slope = "3.3e-4 1/K"
'''
mine = {"gears.pinion.material": "mine", "gears.wheel.material": "mine"}
varied = replace(load_case(rig.text + steel, KEPT | mine), mesh_positions=64)
def nine(n=512):
    c = {name: values[:n] for name, values in NINE.items()}
    return {
        "cold_backlash": c["cold_backlash"], "temperatures.pinion_addendum": c["gear"],
        "temperatures.wheel_addendum": c["gear"],
        "temperatures.housing_below_addendum": c["housing"],
        "temperatures.pinion_bore_below_addendum": c["shaft"],
        "temperatures.wheel_bore_below_addendum": c["shaft"], "operating.torque": c["torque"],
        "dynamics.damping_ratio": c["zeta"], "error_amplitude": c["error"],
        "materials.mine.thermal_expansion": 11.5e-6 * c["expansion"],
        "materials.mine.youngs_modulus": 206e9 * c["stiffness"],
    }
def quasi(n=512, want=EXCITES):
    return quasi_static(varied, nine(n), n, varied.models[0], HOT, want)
"""


@dataclass(frozen=True)
class Row:
    """One answer: its name, the goal in milliseconds, how this tree and the reference give it."""

    name: str
    goal: float
    after: str
    before: str | None = None
    unit: str = "ms"


RUN_UP = """
from thermogear.study.run_up import run_up
speeds = np.linspace(3000, 6000, {count}) * RPM
timed(lambda: run_up(rig, speeds, branch_period=0, temperatures=["hot"], threads=1), {per}, 1)
"""
ORBIT = """
from thermogear.case.one_point import of_case
from thermogear.analysis.orbits import periodic_orbit
point = of_case(load_example("rig", KEPT), operating=1)
model = point.points.model()
guess = periodic_orbit(model, 1, (1.5, 0.0)).state
timed(lambda: periodic_orbit(model, 1, guess + [0.01, 0.0]), 1, 21)
"""
JUMP = """
from thermogear.analysis.bifurcations import FOLD, carried
from thermogear.analysis.continuation import continuation
from thermogear.analysis.orbits import periodic_orbit
from thermogear.case.family import along, family
whole = load_example("rig", KEPT)
slow = family(whole, ("pinion_speed",))
models = along(slow)
start = 4000 * RPM
from thermogear.analysis.settle import settle
from thermogear.case.response import RULE
settled = settle(models(start).flat, np.array([[1.0, 0.0]]), RULE)
orbit = periodic_orbit(models(start), 1, settled.state[0])
branch = continuation(orbit, "pinion_speed", 5500 * RPM, family=models, start=start)
fold = branch.of_kind(FOLD)[0]
others = [along(family(whole.with_values({"torque": t}), ("pinion_speed",)))
          for t in rng.uniform(99.0, 101.0, 12)]
for other in others:
    other(fold.value)
begun = time.process_time()
for other in others:
    carried(fold, other)
print(json.dumps(1e3 * (time.process_time() - begun) / len(others)))
"""
CLI = """
import subprocess, resource, os, tempfile
def cpu():
    with tempfile.TemporaryDirectory() as out:
        begun = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-m", "thermogear", *[{words}], "-o", out + "/r"], check=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
cpu()
print(json.dumps(1e3 * cpu()))
"""

ROWS = (
    Row(
        "quasi-static, nine inputs, a sample", 0.3,
        NEW + "timed(quasi, 512)",
        """
from thermogear.case.family import family
lanes = family(rig, ("gear_temperature", "cold_half_backlash", "torque", "zeta"))
rows = np.column_stack([NINE["gear"], 0.5 * NINE["cold_backlash"], NINE["torque"], NINE["zeta"]])
timed(lambda: lanes.excitations(rows[:32] + rng.normal(size=(32, 4)) * 1e-12), 32, 1)
""",
    ),
    Row(
        "the same, jam temperatures too", 0.3,
        NEW + 'timed(lambda: quasi(512, (*EXCITES, "jam_temperature", '
        '"proportional_jam_temperature")), 512)',
    ),
    Row(
        "geometry varied too, a sample", 3.0,
        NEW + """
from thermogear.case.family import GearFamily
names = ("gears.pinion.profile_shift", "torque")
def work():
    rows = np.column_stack([rng.uniform(0.0, 0.1, 64), NINE["torque"][:64]])
    GearFamily(rig, names).quasi_static(rows, EXCITES)
timed(work, 64)
""",
        """
from thermogear.case.family import family
names = ("gears.pinion.profile_shift", "torque")
def work():
    rows = np.column_stack([rng.uniform(0.0, 0.1, 16), NINE["torque"][:16]])
    family(rig, names).excitations(rows)
timed(work, 16, 1)
""",
    ),
    Row(
        "heat balance closed, a sample", 5.0,
        NEW + """
def columns():
    n = 256
    return {
        "operating.torque": rng.uniform(70, 90, n), "operating.speed": rng.uniform(250, 350, n),
        "gears.pinion.roughness": rng.uniform(0.3e-6, 0.5e-6, n),
        "oil_viscosity": rng.uniform(80e-6, 120e-6, n),
        "cold_backlash": rng.uniform(0.1e-3, 0.2e-3, n),
    }
timed(lambda: quasi_static(own, columns(), 256, own.models[0], HOT, EXCITES), 256)
""",
        """
from thermogear.case.family import family
lanes = family(own, ("pinion_speed", "torque"))
def work():
    n = 64
    lanes.excitations(np.column_stack([rng.uniform(250, 350, n), rng.uniform(70, 90, n)]))
timed(work, 64, 1)
""",
    ),
    Row(
        "settled motion, a sample", 1.0,
        NEW + """
from thermogear.analysis.settle import settle
from thermogear.case.response import RULE
lanes = points_of(sampled(varied, nine(), 512).excited(quasi())).flat
timed(lambda: settle(lanes, np.tile([1.0, 0.0], (512, 1)), RULE), 512, 1)
""",
        """
from thermogear.case.family import family
from thermogear.analysis.settle import settle
from thermogear.case.response import RULE
lanes = family(rig, ("torque", "zeta"))(np.column_stack([NINE["torque"], NINE["zeta"]])).flat
timed(lambda: settle(lanes, np.tile([1.0, 0.0], (512, 1)), RULE), 512, 1)
""",
    ),
    Row("an orbit by Newton", 0.26, ORBIT, ORBIT),
    Row("one jump speed, from a neighbour", 5.0, JUMP),
    Row(
        "run-up, a speed, one chain", 10.0,
        RUN_UP.format(count=120, per=240), RUN_UP.format(count=120, per=240),
    ),
    Row(
        "run-up of 600 speeds up and down", 4000.0,
        RUN_UP.format(count=600, per=1), RUN_UP.format(count=600, per=1),
    ),
    Row(
        "the same, first points", 100.0,
        NEW + """
from thermogear.base.plan import slices
from thermogear.study.run_up import run_up_plan
speeds = np.linspace(3000, 6000, 600) * RPM
def first():
    whole = slices(
        run_up_plan(rig, speeds, branch_period=0, temperatures=["hot"], block=2), threads=1
    )
    next(whole)
    whole.close()
timed(first, 1)
""",
    ),
    Row(
        "a dial move to the stiffness curve", 40.0,
        """
from thermogear.case.samples import quasi_static
from thermogear.case.thermal_state import HOT
whole = load_example("rig", KEPT)
def move():
    case = whole.with_values({"temperatures.pinion_addendum": rng.uniform(393, 423)})
    quasi_static(case, {}, 1, case.models[0], HOT, ("mesh_stiffness", "half_backlash"))
timed(move, 1, 15)
""",
        """
from thermogear.case.thermal_state import HOT
text = load_example("rig", KEPT).text
def move():
    to = f"{rng.uniform(120, 150)!r} degC"
    case = load_case(text, KEPT | {"temperatures.pinion_addendum": to})
    case.cycle(HOT.operating(case, case.models[0]).point(0), case.models[0], 3)
timed(move, 1, 15)
""",
    ),
    Row(
        "a dial move to an orbit", 10.0,
        """
from thermogear.case.family import family
from thermogear.analysis.orbits import periodic_orbit
lanes = family(load_example("rig", KEPT), ("gear_temperature",))
guess = periodic_orbit(lanes(np.array([[413.15]])).model(), 1, (1.5, 0.0)).state
def move():
    model = lanes(np.array([[rng.uniform(403, 423)]])).model()
    periodic_orbit(model, 1, guess)
timed(move, 1, 15)
""",
        """
from thermogear.case.family import family
from thermogear.analysis.orbits import periodic_orbit
lanes = family(load_example("rig", KEPT), ("gear_temperature",))
guess = periodic_orbit(lanes(np.array([[413.15]])).model(), 1, (1.5, 0.0)).state
def move():
    model = lanes(np.array([[rng.uniform(403, 423)]])).model()
    periodic_orbit(model, 1, guess)
timed(move, 1, 15)
""",
    ),
    Row(
        "`runup rig --rpm 3000:6000:60`, hot and cold, branches", 6000.0,
        CLI.format(words='"runup", "rig", "--rpm", "3000:6000:60"'),
        CLI.format(words='"runup", "rig", "--rpm", "3000:6000:60"'),
    ),
    Row(
        "`run` of the rig", 0.0,
        CLI.format(words='"run", "rig"'), CLI.format(words='"run", "rig"'),
    ),
    Row(
        "`answers` of the rig", 0.0,
        CLI.format(words='"answers", "rig"'), CLI.format(words='"answers", "rig"'),
    ),
)  # fmt: skip


def measured(sources: Path, text: str, cache: Path) -> float:
    """Milliseconds of one row by the tree at ``sources``."""
    settings = {
        "PYTHONPATH": str(sources / "src"),
        "PYTHONPYCACHEPREFIX": str(cache),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
    inherited = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    found = subprocess.run(
        [sys.executable, "-c", HEAD + text], env=inherited | settings, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    if found.returncode:
        raise SystemExit(found.stderr[-2000:])
    return float(json.loads(found.stdout.splitlines()[-1]))


def unpacked(reference: str, folder: Path) -> Path:
    """The sources of another commit."""
    packed = subprocess.run(
        ["git", "archive", reference, "src"], cwd=ROOT, capture_output=True, check=True
    ).stdout
    with tarfile.open(fileobj=BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
    return folder


def told(milliseconds: float | None) -> str:
    """A time as a table says it."""
    return "–" if milliseconds is None else f"{milliseconds:.3g}"


def table(rows: list[tuple[Row, float | None, float]], reference: str) -> str:
    """The page."""
    lines = [
        "# What an answer costs",
        "",
        "Written by `make bench NAME=paths`; do not edit. Processor time on one "
        "thread, median of the",
        f"rounds, this tree beside commit {reference} in one run on the same machine",
        f"({platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}).",
        "The rig, with the friction law of Benedict and Kelley and its given temperatures.",
        "",
        "| answer | before [ms] | after [ms] | times | aim [ms] |",
        "|---|---|---|---|---|",
    ]
    for row, before, after in rows:
        times = "–" if before is None else f"{before / after:.1f}"
        aim = told(row.goal) if row.goal else "–"
        lines.append(f"| {row.name} | {told(before)} | {told(after)} | {times} | {aim} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="rows whose name holds this text")
    parser.add_argument("--reference", default=REFERENCE)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    folder = Path(tempfile.mkdtemp())
    rows: list[tuple[Row, float | None, float]] = []
    try:
        old = unpacked(given.reference, folder / "before")
        for row in ROWS:
            if given.only not in row.name:
                continue
            before, after = [], []
            for _ in range(given.rounds):
                if row.before is not None:
                    before.append(measured(old, row.before, folder / "old"))
                after.append(measured(ROOT, row.after, folder / "new"))
            one = (row, statistics.median(before) if before else None, statistics.median(after))
            rows.append(one)
            print(f"{row.name}: {told(one[1])} -> {told(one[2])} ms, aim {told(row.goal)}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    if given.write:
        page = table(rows, given.reference)
        PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
