"""Single damages to finished results and stores: what is read back different without a word.

``make trial NAME=damage`` makes three netCDF files and two stores by the commands' own functions
and damages them in 300 ways drawn beforehand (seed fixed before the first run): bytes, blocks, what
numbers mean, files exchanged. After each the package's readers are asked, and for a store the
command that made it is given again. It writes trials/records/damage.md. ``python
trials/damage.py 40`` prints a short one, ``... costs``
measures the reading alone anew.
"""

from __future__ import annotations

import hashlib
import json
import random
import shutil
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from thermogear.analysis.diagram import diagram_plan
from thermogear.analysis.maps import map_plan
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError
from thermogear.base.netcdf import read_tree, write_tree
from thermogear.base.plan import Plan, Variable, ranges_of
from thermogear.base.stores import RESULT, read_store
from thermogear.case.case import load_example
from thermogear.dynamics.models import TorsionalModel
from thermogear.results.work import carry_out
from thermogear.study.friction import friction_survey
from thermogear.study.run import run
from thermogear.views.write import save_results

SEED = 14_2026
COUNT = 300
PAGE = Path(__file__).parents[1] / "trials" / "records" / "damage.md"
BLOCK = 512
REFUSED, SAME, TOLD, SILENT, BROKEN = (
    "refused in one line",
    "read back the same",
    "read back different, with a word",
    "read back different without a word",
    "traceback",
)
NEVER = (SILENT, BROKEN)
COSTS = "| reading | MB | without the check, processor s | the check adds, % |"
MODEL = TorsionalModel(
    damping_ratio=0.05, frequency=1.0, stiffness_amplitude=0.3, mean_force=0.1, force_amplitude=0.3
)
Draw = random.Random


@dataclass(frozen=True)
class Specimen:
    """A finished directory, another of the same kind, its reader, and what that should read.

    ``again`` gives the command once more, for what can be repaired.
    """

    name: str
    place: Path
    other: Path
    read: Callable[[Path], Any]
    truth: Any
    again: Callable[[Path], Any] | None = None


# --- what is damaged ------------------------------------------------------------------------


def files(directory: Path, own: bool = False) -> list[Path]:
    """What holds results, relative; ``own`` leaves out what only stands beside them."""
    beside = {"lock", ".thermogear", "summary.json", "friction.json"}
    found = [p.relative_to(directory) for p in directory.rglob("*") if p.is_file()]
    return sorted(p for p in found if not (own and p.name in beside))


def specimens(place: Path, short: bool = False) -> list[Specimen]:
    """Made by the same functions as the commands use."""
    made = []
    for name, plan in plans().items():
        if not (short and name != "map"):
            made.append(store_specimen(name, place, plan))
    small = ("grid.path_positions=41", "operating.speed=2000 rpm")
    rig, slow = (
        load_example("rig", small),
        load_example("rig", (*small, "operating.torque=150 N m")),
    )
    for case, end in ((rig, "one"), (slow, "other")):
        folder = place / "survey" / end
        folder.mkdir(parents=True)
        friction_survey(case).put(folder)
    made.append(tree_specimen("survey", place))
    if not short:
        warmer = load_example("section-4.1", ("base.damping_ratio=0.16",))
        pairs = {
            "run of gears": (rig, slow),
            "run of numbers": (load_example("section-4.1"), warmer),
        }
        for name, (one, other) in pairs.items():
            save_results(run(one), place / name / "one")
            save_results(run(other), place / name / "other")
            made.append(tree_specimen(name, place))
    return made


def plans() -> dict[str, Callable[[float], Plan]]:
    grid = {"frequency": np.linspace(0.4, 2.2, 12), "mean_force": np.linspace(0.05, 0.9, 12)}
    row = np.linspace(0.9, 1.0, 6)
    return {
        "map": lambda zeta: map_plan(
            MODEL.replace(damping_ratio=zeta), grid, tile=6, rule=Rule(cap=512)
        ),
        "diagram": lambda zeta: diagram_plan(
            MODEL.replace(damping_ratio=zeta), "frequency", row, block=2, branch_period=1
        ),
    }


def store_specimen(name: str, place: Path, plan: Callable[[float], Plan]) -> Specimen:
    one, other = place / name / "one", place / name / "other"
    carry_out(plan(0.05), one)
    carry_out(plan(0.06), other)
    return Specimen(
        f"store of a {name}", one, other, read_store, read_store(one),
        lambda directory: carry_out(plan(0.05), directory),
    )  # fmt: skip


def tree_specimen(name: str, place: Path) -> Specimen:
    one = place / name / "one"
    kind = next(p.name for p in sorted(one.iterdir()) if p.suffix == ".nc")

    def read(directory: Path) -> xr.DataTree:
        return read_tree(directory / kind)

    return Specimen(f"file of a {name}", one, place / name / "other", read, read(one))


# --- how it is damaged ----------------------------------------------------------------------


def _large(directory: Path, draw: Draw) -> Path:
    """A file of the results, larger ones more often."""
    found = files(directory, own=True)
    return directory / draw.choices(found, [1 + (directory / f).stat().st_size for f in found])[0]


def _bytes(change: Callable[[bytearray, Draw], None]) -> Callable[[Specimen, Path, Draw], None]:
    def damage(one: Specimen, directory: Path, draw: Draw) -> None:
        path = _large(directory, draw)
        raw = bytearray(path.read_bytes())
        change(raw, draw)
        path.write_bytes(raw)

    return damage


def _flip(raw: bytearray, draw: Draw) -> None:
    raw[draw.randrange(len(raw))] ^= 1 << draw.randrange(8)


def _byte(raw: bytearray, draw: Draw) -> None:
    raw[draw.randrange(len(raw))] ^= draw.randrange(1, 256)


def _zeros(raw: bytearray, draw: Draw) -> None:
    at = draw.randrange(len(raw))
    raw[at : at + BLOCK] = bytes(len(raw[at : at + BLOCK]))


def _noise(raw: bytearray, draw: Draw) -> None:
    at = draw.randrange(len(raw))
    raw[at : at + BLOCK] = draw.randbytes(len(raw[at : at + BLOCK]))


def _exchange(raw: bytearray, draw: Draw) -> None:
    size = min(BLOCK, len(raw) // 2)
    a, b = sorted((draw.randrange(len(raw) - size + 1), draw.randrange(len(raw) - size + 1)))
    raw[a : a + size], raw[b : b + size] = raw[b : b + size], raw[a : a + size]


def _cut(raw: bytearray, draw: Draw) -> None:
    del raw[draw.randrange(len(raw)) :]


def _longer(raw: bytearray, draw: Draw) -> None:
    raw += draw.randbytes(BLOCK)


def _gone(one: Specimen, directory: Path, draw: Draw) -> None:
    (directory / draw.choice(files(directory, own=True))).unlink()


def _of_another(one: Specimen, directory: Path, draw: Draw) -> None:
    shared = [p for p in files(directory, own=True) if (one.other / p).is_file()]
    name = draw.choice(shared)
    (directory / name).write_bytes((one.other / name).read_bytes())


def _two_files(one: Specimen, directory: Path, draw: Draw) -> None:
    a, b = (directory / name for name in draw.sample(files(directory, own=True), 2))
    first, second = a.read_bytes(), b.read_bytes()
    a.write_bytes(second)
    b.write_bytes(first)


BYTES: dict[str, Callable[[Specimen, Path, Draw], None]] = {
    "a bit flipped": _bytes(_flip),
    "a byte changed": _bytes(_byte),
    "512 bytes zeroed": _bytes(_zeros),
    "512 bytes of noise": _bytes(_noise),
    "two blocks exchanged": _bytes(_exchange),
    "cut off": _bytes(_cut),
    "grown": _bytes(_longer),
    "a file missing": _gone,
    "a file of another result": _of_another,
    "two files exchanged": _two_files,
}


def _in_hdf5(change: Callable[[list[h5py.Dataset], Draw], None]) -> Callable[..., None]:
    """A change that leaves a right HDF5 file."""

    def damage(one: Specimen, directory: Path, draw: Draw) -> None:
        path = next(p for p in sorted(directory.iterdir()) if p.suffix == ".nc")
        found: list[h5py.Dataset] = []
        with h5py.File(path, "r+") as file:
            file.visititems(
                lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) else None
            )
            change(found, draw)

    return damage


def _number(found: list[h5py.Dataset], draw: Draw) -> None:
    one = draw.choice([d for d in found if d.dtype.kind == "f" and d.size and np.any(d[()])])
    one[...] = one[()] * 1.001


def _units(found: list[h5py.Dataset], draw: Draw) -> None:
    one = draw.choice([d for d in found if "units" in d.attrs])
    one.attrs["units"] = "mm" if one.attrs["units"] != "mm" else "m"


def _meanings(found: list[h5py.Dataset], draw: Draw) -> None:
    one = draw.choice([d for d in found if "flag_meanings" in d.attrs])
    one.attrs["flag_meanings"] = " ".join(reversed(str(one.attrs["flag_meanings"]).split()))


def _names(found: list[h5py.Dataset], draw: Draw) -> None:
    curves = [d for d in found if d.dtype.kind == "f" and d.size > 1]
    a = draw.choice(curves)
    alike = [d for d in curves if d.shape == a.shape and d.parent == a.parent and d != a]
    b = draw.choice(alike or [d for d in curves if d != a])
    first, second = a[()], b[()]
    if first.shape == second.shape:
        a[...], b[...] = second, first
    else:
        a[...] = a[()][::-1]


def _foreign_group(found: list[h5py.Dataset], draw: Draw) -> None:
    one = draw.choice(found)
    one.file.create_dataset("foreign/force", data=np.arange(3.0))


TREES = {
    "numbers off by 0.1 %": _in_hdf5(_number),
    "other units": _in_hdf5(_units),
    "flag meanings reversed": _in_hdf5(_meanings),
    "two arrays exchanged": _in_hdf5(_names),
    "a foreign array": _in_hdf5(_foreign_group),
}


def _in_json(change: Callable[[dict[str, Any], Draw], bool]) -> Callable[..., None]:
    """A change to the zarr.json of an array that it makes sense for."""

    def damage(one: Specimen, directory: Path, draw: Draw) -> None:
        paths = sorted((directory / RESULT).glob("*/zarr.json"))
        for path in draw.sample(paths, len(paths)):
            content = json.loads(path.read_text())
            if change(content, draw):
                path.write_text(json.dumps(content))
                return
        raise LookupError("no array to change")

    return damage


def _json_units(content: dict[str, Any], draw: Draw) -> bool:
    has = "units" in content["attributes"]
    content["attributes"]["units"] = "mm"
    return has


def _json_meanings(content: dict[str, Any], draw: Draw) -> bool:
    words = str(content["attributes"].get("flag_meanings", "")).split()
    content["attributes"]["flag_meanings"] = " ".join(reversed(words))
    return len(words) > 1


def _json_dims(content: dict[str, Any], draw: Draw) -> bool:
    names = content.get("dimension_names") or []
    content["dimension_names"] = list(reversed(names))
    return len(names) > 1


def _json_fill(content: dict[str, Any], draw: Draw) -> bool:
    content["attributes"]["long_name"] = "something else"
    return True


def _arrays(one: Specimen, directory: Path, draw: Draw) -> None:
    """The zarr.json of two arrays of one type and shape exchanged."""
    paths = sorted((directory / RESULT).glob("*/zarr.json"))
    a = draw.choice(paths)
    like = [p for p in paths if p != a and _form(p) == _form(a)]
    b = draw.choice(like or [p for p in paths if p != a])
    first, second = a.read_bytes(), b.read_bytes()
    a.write_bytes(second)
    b.write_bytes(first)


def _form(path: Path) -> tuple[str, ...]:
    content = json.loads(path.read_text())
    return str(content["shape"]), str(content["data_type"])


def _foreign(one: Specimen, directory: Path, draw: Draw) -> None:
    found = sorted(p for p in (directory / RESULT).iterdir() if p.is_dir())
    shutil.copytree(draw.choice(found), directory / RESULT / "foreign")


STORES = {
    "other units": _in_json(_json_units),
    "flag meanings reversed": _in_json(_json_meanings),
    "dimension names exchanged": _in_json(_json_dims),
    "another long name": _in_json(_json_fill),
    "metadata of two arrays exchanged": _arrays,
    "a foreign array": _foreign,
}


# --- one trial ------------------------------------------------------------------------------


def asked(one: Specimen, directory: Path) -> str:
    """What the reader says of a damaged directory."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            seen = one.read(directory)
        except InputError as error:
            return REFUSED if "\n" not in str(error) else BROKEN
        except Exception:  # the finding itself
            return BROKEN
    if seen.identical(one.truth):
        return SAME
    return TOLD if said else SILENT


def repaired(one: Specimen, directory: Path) -> str:
    """What the command that made a store makes of a damaged one."""
    if one.again is None:
        return ""
    try:
        one.again(directory)
        same = one.read(directory).identical(one.truth)
    except InputError:
        return "refused by the command"
    return "repaired by the command" if same else "WRONG after the command"


def trial(one: Specimen, how: str, draw: Draw, scratch: Path) -> tuple[str, str]:
    """Damage a copy in one way; what the reader, then what the command makes of it."""
    directory = scratch / "damaged"
    shutil.rmtree(directory, ignore_errors=True)
    shutil.copytree(one.place, directory)
    (BYTES | (STORES if one.again else TREES))[how](one, directory, draw)
    return asked(one, directory), repaired(one, directory)


def drawn(made: Sequence[Specimen], count: int) -> list[tuple[Specimen, str, Draw]]:
    """Which specimen, which way, and the random numbers of each; half files, half stores."""
    draw = Draw(SEED)
    stores, trees = [s for s in made if s.again], [s for s in made if not s.again]
    found = []
    for number in range(count):
        one = draw.choice(stores if number % 2 else trees)
        ways = list(BYTES | (STORES if one.again else TREES))
        found.append((one, draw.choice(ways), Draw(draw.getrandbits(64))))
    return found


# --- what the check costs -------------------------------------------------------------------


@dataclass(frozen=True)
class Numbers:
    """A plan of many numbers that cost nothing: to time the reading."""

    count: int = 256
    kind: str = "numbers"

    @property
    def sizes(self) -> dict[str, int]:
        return {"row": self.count, "place": 16_384}

    @property
    def cuts(self) -> dict[str, int]:
        return {"row": 32}

    def inputs(self) -> dict[str, Any]:
        return {"count": self.count}

    def variables(self) -> dict[str, Variable]:
        dims = ("row", "place")
        return {
            "force": Variable(dims, "f8", 0.0, {"units": "N"}),
            "status": Variable(dims, "i1", 0, {"units": "1"}),
        }

    def coordinates(self) -> dict[str, Any]:
        return {}

    def needs(self, key: tuple[int, ...]) -> None:
        return None

    def pilot(self, points: int) -> int:
        return points

    def compute(self, key: tuple[int, ...], before: Any, alive: Any) -> dict[str, Any]:
        rows = ranges_of(self, key)["row"]
        shape = (rows.stop - rows.start, 16_384)
        values = np.random.default_rng(key[0]).normal(size=shape)
        return {"force": values, "status": np.zeros(shape, np.int8)}

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        return data


def _seconds(*works: Callable[[], object], least: int = 3, spend: float = 4.0) -> list[float]:
    """The least processor seconds of each, taken in turns: other work on the machine hides."""
    found: list[list[float]] = [[] for _ in works]
    while len(found[0]) < least or sum(map(sum, found)) < spend:
        for times, work in zip(found, works, strict=True):
            began = time.process_time()
            work()
            times.append(time.process_time() - began)
    return [min(times) for times in found]


def costs(made: Sequence[Specimen], scratch: Path) -> list[tuple[str, float, float, float]]:
    """(what, MB, seconds of reading without the check, per cent the check adds)."""
    large = scratch / "large"
    large.mkdir()
    values = np.random.default_rng(1).normal(size=(64, 131_072))
    write_tree(xr.DataTree(xr.Dataset({"force": (("row", "place"), values)})), large / "results.nc")
    carry_out(Numbers(), scratch / "large-store", threads=2)
    rows = []
    trees = [(s.name, next(s.place.glob("*.nc"))) for s in made if not s.again]
    for name, path in (*trees, ("large file", large / "results.nc")):
        raw = path.read_bytes()
        check, whole = _seconds(partial(hashlib.sha256, raw), partial(read_tree, path))
        rows.append((name, len(raw) / 1e6, whole - check, 100.0 * check / (whole - check)))
    stores = [(s.name, s.place) for s in made if s.again]
    for name, place in (*stores, ("large store", scratch / "large-store")):
        plain, whole = _seconds(partial(_unchecked, place), partial(read_store, place))
        size = sum(p.stat().st_size for p in (place / RESULT).rglob("*") if p.is_file()) / 1e6
        rows.append((name, size, plain, 100.0 * (whole / plain - 1.0)))
    return rows


def _unchecked(place: Path) -> xr.Dataset:
    with xr.open_zarr(place / RESULT, consolidated=False, mask_and_scale=False) as data:
        loaded: xr.Dataset = data.load()
    return loaded


# --- the page -------------------------------------------------------------------------------


def page(found: Sequence[tuple[str, str, str, str]]) -> str:
    """``found``: kind of specimen, way of damage, what the reader said, what the command did."""
    told = Counter(row[2] for row in found)
    after = Counter(row[3] for row in found if row[3])
    columns = [REFUSED, SAME, TOLD, SILENT, BROKEN]
    lines = [
        "# Damages to results",
        "",
        f"`make trial NAME=damage` (seed {SEED}): {len(found)} single damages to "
        f"finished files and "
        "stores.",
        "",
        "| what the reader said | |",
        "|---|---:|",
        *(f"| {what} | {told[what]} |" for what in columns),
        "",
        "| a store, by the command that made it | |",
        "|---|---:|",
        *(f"| {what} | {count} |" for what, count in sorted(after.items())),
        "",
        "| damage | " + " | ".join(columns) + " |",
        "|---|" + "---:|" * len(columns),
    ]
    for kind in ("file", "store"):
        rows = [row for row in found if row[0] == kind]
        for way in sorted({row[1] for row in rows}):
            count = Counter(row[2] for row in rows if row[1] == way)
            lines.append(f"| {kind}: {way} | " + " | ".join(str(count[c]) for c in columns) + " |")
    lines += [
        "",
        "Read back the same: the damage hit what no number and no word of the result depends on "
        "(a copy of the",
        "manifest, the end of the journal, a lost seal, which is told), or changed nothing (zeros, "
        "equal files).",
        "",
    ]
    return "\n".join(lines)


def cost_table(rows: Sequence[tuple[str, float, float, float]]) -> str:
    """What :func:`costs` returns, as the page's last table."""
    lines = [
        COSTS,
        "|---|---:|---:|---:|",
        *(f"| {name} | {size:.3g} | {s:.3g} | {cost:.2g} |" for name, size, s, cost in rows),
        "",
    ]
    return "\n".join(lines)


def only_costs() -> int:
    """Measure the reading anew and put it into the committed page."""
    with tempfile.TemporaryDirectory() as name:
        table = cost_table(costs(specimens(Path(name)), Path(name)))
    PAGE.write_text(PAGE.read_text("utf-8").partition(COSTS)[0] + table, "utf-8")
    print(table)
    return 0


def main(words: Sequence[str]) -> int:
    if words == ["costs"]:
        return only_costs()
    count = int(words[0]) if words else COUNT
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        made = specimens(scratch)
        found = []
        for number, (one, how, draw) in enumerate(drawn(made, count)):
            said, then = trial(one, how, draw, scratch)
            found.append((one.name.split()[0], how, said, then))
            if said in NEVER or then.startswith("WRONG"):
                print(f"damage {number}: {one.name}, {how}: {said}; {then}", flush=True)
            if sys.stderr.isatty() or (number + 1) % 50 == 0:
                print(f"\r{number + 1} of {count}", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        text = page(found) + "\n" + cost_table(costs(made, scratch))
    if words:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
        print(PAGE.relative_to(Path.cwd()) if PAGE.is_relative_to(Path.cwd()) else PAGE)
    return int(any(row[2] in NEVER or row[3].startswith("WRONG") for row in found))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
