"""The store: resumed, refused, repaired, never silently wrong."""

import hashlib
import json
import shutil
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from thermogear.analysis.basins import basin_plan
from thermogear.analysis.diagram import diagram_plan
from thermogear.analysis.maps import map_plan
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError
from thermogear.base.plan import gather, keys_of
from thermogear.base.progress import duration
from thermogear.base.stores import COPY, JOURNAL, MANIFEST, RESULT, read_store
from thermogear.dynamics.models import TorsionalModel
from thermogear.results.result import open_results as read_result
from thermogear.results.store import QUARANTINE, Store
from thermogear.results.work import carry_out, estimate, require_space

MODEL = TorsionalModel(
    damping_ratio=0.05, frequency=1.0, stiffness_amplitude=0.3, mean_force=0.1, force_amplitude=0.3
)


def plan_of(count=12, tile=6, damping=0.05):
    axes = {
        "frequency": np.linspace(0.4, 2.2, count),
        "stiffness_amplitude": np.linspace(0.05, 0.9, count),
    }
    return map_plan(MODEL.replace(damping_ratio=damping), axes, tile=tile, rule=Rule(cap=512))


def same_numbers(one, other):
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        assert np.array_equal(
            one[name].values, other[name].values, equal_nan=one[name].dtype.kind == "f"
        )


@pytest.fixture(scope="module")
def memory():
    return gather(plan_of())


def test_store_threads_and_memory_agree_to_the_last_bit(tmp_path, memory):
    for threads in (1, 3):
        place = tmp_path / str(threads)
        assert carry_out(plan_of(), place, threads=threads).identical(memory)
        same_numbers(read_store(place), memory)


def test_xarray_opens_the_result_without_us(tmp_path, memory):
    carry_out(plan_of(), tmp_path / "s")
    with (
        warnings.catch_warnings(),
        xr.open_zarr(tmp_path / "s" / RESULT, consolidated=False) as data,
    ):
        # a count of nothing is missing there, and not 0
        known = memory.assign(period=memory.period.where(memory.period > 0))
        assert known.period.isnull().any()
        same_numbers(data.load(), known)
        assert data.frequency.attrs["units"] == "1"
        assert data.attrs["kind"] == "map"


@pytest.mark.parametrize(
    "plan",
    [
        lambda: diagram_plan(
            MODEL, "frequency", np.linspace(0.9, 1.0, 6), block=2, branch_period=1
        ),
        lambda: basin_plan(MODEL, x=np.linspace(-2, 2, 9), v=np.linspace(-2, 2, 9), survey=4),
    ],
    ids=["diagram", "basins"],
)
def test_other_plans_come_back_as_they_were(tmp_path, plan):
    same_numbers(carry_out(plan(), tmp_path / "s"), gather(plan()))
    same_numbers(read_store(tmp_path / "s"), gather(plan()))


def test_unfinished_work_goes_on_and_keeps_what_is_done(tmp_path, memory):
    class Enough(Exception):
        pass

    def stop(step):
        if step.done == 2:
            raise Enough

    with pytest.raises(Enough):
        carry_out(plan_of(), tmp_path / "s", threads=1, report=stop)
    steps = []
    with pytest.raises(InputError, match="it is not finished"):
        read_store(tmp_path / "s")
    data = carry_out(plan_of(), tmp_path / "s", threads=1, report=steps.append)
    assert steps[0].found == 2
    assert (steps[0].done, steps[-1].done, steps[-1].total) == (2, 4, 4)
    assert steps[-1].remaining == 0.0
    assert data.identical(memory)


def test_chains_resume_in_the_middle(tmp_path):
    plan = diagram_plan(MODEL, "frequency", np.linspace(0.9, 1.0, 8), block=2, branch_period=0)

    def stop(step):
        if step.done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        carry_out(plan, tmp_path / "s", threads=2, report=stop)
    same_numbers(carry_out(plan, tmp_path / "s"), gather(plan))


def test_other_inputs_are_refused_by_the_first_field(tmp_path):
    carry_out(plan_of(), tmp_path / "s")
    with pytest.raises(InputError) as caught:
        carry_out(plan_of(damping=0.06), tmp_path / "s")
    assert str(caught.value) == (
        f"model.damping_ratio: got 0.06; allowed 0.05; the store {tmp_path / 's'} was begun with "
        "the latter; name another directory, or repeat the command the store was begun with"
    )
    with pytest.raises(InputError, match=r"axes\.frequency: got 13 values; allowed 12 values"):
        carry_out(plan_of(13), tmp_path / "s")
    with pytest.raises(InputError, match=r"rule\.cap: got 1024; allowed 512"):
        carry_out(replace(plan_of(), rule=Rule(cap=1024)), tmp_path / "s")
    with pytest.raises(InputError, match="kind: got basins; allowed map"):
        carry_out(basin_plan(MODEL, x=[0.0, 1.0], v=[0.0, 1.0], survey=2), tmp_path / "s")


def test_foreign_directories_and_files_are_refused(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.doc").write_text("do not touch")
    with pytest.raises(InputError, match="the directory holds files that are not a store"):
        carry_out(plan_of(), tmp_path / "mine")
    with pytest.raises(InputError, match="it is a file"):
        carry_out(plan_of(), tmp_path / "mine" / "thesis.doc")
    assert [p.name for p in (tmp_path / "mine").iterdir()] == ["thesis.doc"]


def test_second_writer_is_refused(tmp_path):
    with (
        Store(tmp_path / "s", plan_of()),
        pytest.raises(InputError, match="another process is writing into it"),
    ):
        carry_out(plan_of(), tmp_path / "s")


@pytest.mark.slow
def test_corruptions_are_repaired(tmp_path, at_length):
    count = at_length(6, 100, "damages to a finished store")
    found = trial("corruptions", tmp_path, count)
    assert found == {"repaired": count, "loud": 0, "silent": 0, "reader_silent": 0}


def test_damaged_chunk_goes_to_quarantine(tmp_path, memory):
    carry_out(plan_of(), tmp_path / "s")
    chunk = tmp_path / "s" / RESULT / "lyapunov" / "c" / "0" / "1"
    raw = bytearray(chunk.read_bytes())
    raw[len(raw) // 2] ^= 8
    chunk.write_bytes(raw)
    with pytest.raises(InputError, match="it is damaged"):
        read_store(tmp_path / "s")
    assert carry_out(plan_of(), tmp_path / "s").identical(memory)
    names = [p.name for p in (tmp_path / "s" / QUARANTINE).iterdir()]
    assert any(name.endswith("lyapunov-c-0-1") for name in names)


def test_a_chunk_put_in_anothers_place_is_noticed(tmp_path, memory):
    """Its own checksum is right; the journal's is not."""
    carry_out(plan_of(), tmp_path / "s")
    place = tmp_path / "s" / RESULT / "multiplier_real" / "c"
    (place / "0" / "0").write_bytes((place / "1" / "1").read_bytes())
    assert carry_out(plan_of(), tmp_path / "s").identical(memory)


def test_both_manifests_damaged_is_loud(tmp_path):
    carry_out(plan_of(), tmp_path / "s")
    for name in (MANIFEST, COPY):
        (tmp_path / "s" / name).write_text("{}")
    with pytest.raises(InputError, match="both copies of its manifest are damaged"):
        carry_out(plan_of(), tmp_path / "s")


def test_torn_journal_line_costs_its_chunk_alone(tmp_path, memory):
    carry_out(plan_of(), tmp_path / "s")
    journal = tmp_path / "s" / JOURNAL
    lines = journal.read_bytes().split(b"\n")
    journal.write_bytes(b"\n".join([lines[0], lines[1], lines[2][:40]]))
    steps = []
    assert carry_out(plan_of(), tmp_path / "s", report=steps.append).identical(memory)
    assert steps[0].found == 2
    assert len(keys_of(plan_of())) == 4


def test_too_large_work_is_refused_before_it_starts(tmp_path):
    huge = map_plan(
        MODEL, {"frequency": np.arange(1, 400_001), "mean_force": np.arange(1, 400_001)}
    )
    with pytest.raises(InputError, match=r"grid: got 160000000000 points, about .* GiB of memory"):
        require_space(huge, tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_estimate_counts_points_chunks_and_bytes():
    found = estimate(plan_of(), threads=1)
    assert (found.points, found.chunks) == (144, 4)
    assert found.disk == 144 * (8 * 11 + 4 + 2)
    assert 0.0 < found.seconds < 60.0
    assert duration(30.0) == "30 s"
    assert duration(600.0) == "10 min"
    assert duration(7200.0) == "2 h"


def trial(name: str, directory: Path, count: int = 1) -> dict:
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("store_trials.py"), name, directory, str(count)],
        capture_output=True, text=True, timeout=560, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
def test_kills_lose_nothing_that_is_finished(tmp_path, at_length):
    count = at_length(12, 200, "kills of a run at random moments")
    found = trial("kills", tmp_path, count)
    assert found["kills"] == count
    assert found["with_chunks"] > count // 4
    assert (found["lost"], found["wrong"]) == (0, 0)


@pytest.mark.slow
def test_full_disk_is_an_error_and_costs_nothing_else(tmp_path):
    found = trial("full", tmp_path)
    assert found["refused"]
    assert found["same"]


# --- what the numbers mean --------------------------------------------------------------------


def other_units(content):
    content["attributes"]["units"] = "mm"


def other_meanings(content):
    words = content["attributes"]["flag_meanings"].split()
    content["attributes"]["flag_meanings"] = " ".join(reversed(words))


def other_dimensions(content):
    content["dimension_names"].reverse()


def changed(name, change):
    def damage(result):
        path = result / name / "zarr.json"
        content = json.loads(path.read_text())
        change(content)
        path.write_text(json.dumps(content))

    return damage


def exchanged(result):
    """Both of one shape and type: no number says which is which."""
    one, two = (result / name / "zarr.json" for name in ("multiplier_real", "lyapunov"))
    first, second = one.read_bytes(), two.read_bytes()
    one.write_bytes(second)
    two.write_bytes(first)


def foreign(result):
    shutil.copytree(result / "label", result / "foreign")


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    place = tmp_path_factory.mktemp("finished") / "s"
    carry_out(plan_of(), place)
    return place


def test_what_is_whole_leaves_no_quarantine(finished):
    assert not (finished / QUARANTINE).exists()


@pytest.mark.parametrize(
    "damage",
    [
        changed("frequency", other_units),
        changed("label", other_meanings),
        changed("lyapunov", other_dimensions),
        exchanged,
        foreign,
    ],
    ids=["units", "meanings", "dimensions", "exchanged", "foreign"],
)
def test_what_the_numbers_mean_is_sealed(damage, finished, tmp_path, memory):
    """All five were accepted, and drawn."""
    store = tmp_path / "s"
    shutil.copytree(finished, store)
    damage(store / RESULT)
    with pytest.raises(InputError, match=r"it is damaged or changed \(.*; repeat the command that"):
        read_store(store)
    with pytest.raises(InputError, match="it is damaged or changed"):
        read_result(store)
    assert carry_out(plan_of(), store).identical(memory)
    assert read_store(store).attrs == read_store(finished).attrs


def test_a_manifest_of_other_work_is_refused(finished, tmp_path):
    store, other = tmp_path / "s", tmp_path / "o"
    shutil.copytree(finished, store)
    with Store(other, plan_of(damping=0.06)):
        pass
    (store / MANIFEST).write_bytes((other / MANIFEST).read_bytes())
    same_numbers(read_store(store), read_store(finished))  # by its copy
    (store / COPY).write_bytes((other / MANIFEST).read_bytes())
    with pytest.raises(InputError, match="its manifest is of other work"):
        read_store(store)


def test_stores_of_another_format_say_so(finished, tmp_path):
    store = tmp_path / "s"
    shutil.copytree(finished, store)
    for name in (MANIFEST, COPY):
        text = (store / name).read_text().partition("\n")[2].rstrip("\n")
        text = text.replace('"format": 2', '"format": 1')
        seal = hashlib.sha256(text.encode()).hexdigest()
        (store / name).write_text(f"{seal}\n{text}\n")
    with pytest.raises(InputError, match="another version of thermogear wrote it"):
        read_store(store)
