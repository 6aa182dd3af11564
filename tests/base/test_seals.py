"""Files and folders that are whole or not there; seals; one writer at a time."""

from __future__ import annotations

import errno
import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from thermogear.base import files
from thermogear.base.errors import InputError, UnsealedWarning
from thermogear.base.files import (
    LOCK,
    beside,
    held,
    open_sealed,
    put,
    put_new,
    put_sealed,
    seal_of,
    together,
)
from thermogear.base.netcdf import read_tree, write_tree


def tree(values: object = range(3)) -> xr.DataTree:
    data = xr.Dataset({"force": (("place",), np.array(list(values)), {"units": "N"})})  # type: ignore[call-overload]
    return xr.DataTree(data, name=None)


def names(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def fill(directory: Path, stop: BaseException | None = None, **texts: str) -> None:
    """Put files (``csv__a`` is csv/a) together into ``directory``; stop before the end."""
    with together(directory) as folder:
        for name, text in texts.items():
            path = folder.joinpath(*name.split("__"))
            path.parent.mkdir(exist_ok=True)
            put(path, text)
        if stop is not None:
            raise stop


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that takes no more than 100 bytes of any file."""
    real = files._write

    def write(path: Path, data: bytes) -> None:
        real(path, data[:100])
        if len(data) > 100:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(files, "_write", write)


def test_a_seal_is_what_sha256sum_writes(tmp_path: Path) -> None:
    path = put_sealed(tmp_path / "results.nc", b"numbers")
    digest = hashlib.sha256(b"numbers").hexdigest()
    assert seal_of(path).read_bytes() == f"{digest}  results.nc\n".encode()
    file, sealed = open_sealed(path, field="results")
    assert (file.read(), sealed) == (b"numbers", True)
    assert names(tmp_path) == ["results.nc", "results.nc.sha256"]


def test_what_a_seal_does_not_vouch_for_is_refused(tmp_path: Path) -> None:
    one, two = put_sealed(tmp_path / "a.nc", b"one"), put_sealed(tmp_path / "b.nc", b"two")
    one.write_bytes(b"One")
    with pytest.raises(InputError, match=r"a\.nc\.sha256 vouches for.*; run it again$"):
        open_sealed(one, field="results", fix="run it again")
    # not even with its own seal in the place of another file
    two.replace(one)
    seal_of(two).replace(seal_of(one))
    with pytest.raises(InputError, match="vouches for"):
        open_sealed(one, field="results")
    seal_of(one).write_bytes(b"")
    with pytest.raises(InputError, match="vouches for"):
        open_sealed(one, field="results")
    with pytest.raises(InputError, match="there is no such file"):
        open_sealed(two, field="results")


def test_at_every_moment_a_seal_vouches_for_the_file_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = put_sealed(tmp_path / "results.nc", b"old")
    real, seen = Path.replace, []

    def replace(self: Path, target: Path) -> Path:
        seen.append(open_sealed(path, field="results")[0].read())
        done = real(self, target)
        seen.append(open_sealed(path, field="results")[0].read())
        return done

    monkeypatch.setattr(Path, "replace", replace)
    put_sealed(path, b"new")
    assert set(seen) == {b"old", b"new"}
    with together(tmp_path) as folder:
        put_sealed(folder / "results.nc", b"newer")
    assert set(seen) == {b"old", b"new", b"newer"}
    assert seal_of(path).read_text().count("\n") == 1


def test_trees_come_back_and_say_when_they_are_not_sealed(tmp_path: Path) -> None:
    path = write_tree(tree(), tmp_path / "results.nc")
    assert read_tree(path).identical(tree())
    seal_of(path).unlink()
    with pytest.warns(UnsealedWarning, match=r"has no results\.nc\.sha256 beside it"):
        assert read_tree(path).identical(tree())


@pytest.mark.usefixtures("full")
def test_a_full_disk_leaves_the_old_and_nothing_half(tmp_path: Path) -> None:
    put_sealed(tmp_path / "results.nc", b"old")
    before = names(tmp_path)
    with pytest.raises(OSError, match="No space left") as caught:
        write_tree(tree(), tmp_path / "results.nc")
    assert caught.value.filename == str(tmp_path / "results.nc")
    assert names(tmp_path) == before
    with pytest.raises(OSError, match="No space left") as caught:
        fill(tmp_path, other="fits", page="x" * 101)
    assert caught.value.filename == str(tmp_path / "page")
    assert names(tmp_path) == before
    assert open_sealed(tmp_path / "results.nc", field="results")[0].read() == b"old"


def test_hdf5_that_cannot_write_does_not_fall(tmp_path: Path) -> None:
    """The process ended in a segmentation fault here, with a file of half its length."""
    code = (
        "import resource, sys, numpy as np, xarray as xr\n"
        "from pathlib import Path\n"
        "from thermogear.base.netcdf import write_tree\n"
        "tree = xr.DataTree(xr.Dataset({'x': ('n', np.arange(1e5))}))\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))\n"
        "try:\n"
        "    write_tree(tree, Path(sys.argv[1]) / 'results.nc')\n"
        "except OSError as error:\n"
        "    print(error.strerror)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "File too large\n", "")
    assert names(tmp_path) == []


def test_a_folder_is_put_in_place_whole_or_not_at_all(tmp_path: Path) -> None:
    fill(tmp_path, page="old")
    for stop in (ValueError("no"), KeyboardInterrupt()):
        with pytest.raises(type(stop)) as caught:
            fill(tmp_path, stop, page="new", more="new")
        assert names(tmp_path) == ["page"]
        assert (tmp_path / "page").read_text() == "old"
    assert caught.value.args == (f"nothing was written to {tmp_path}",)
    fill(tmp_path, page="new", csv__a="1")
    assert names(tmp_path) == ["csv", "page"]
    assert (tmp_path / "page").read_text() == "new"


def test_links_to_elsewhere_are_not_followed(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    for place in (here, there):
        place.mkdir()
    put(there / "measured", "mine")
    (here / "measured").symlink_to(there / "measured")
    fill(here, measured="new")
    assert (there / "measured").read_text() == "mine"
    assert not (here / "measured").is_symlink()
    (here / "csv").symlink_to(there)
    with pytest.raises(InputError, match="it is a link; remove the link"):
        fill(here, csv__measured="new")
    assert names(there) == ["measured"]
    (here / LOCK).symlink_to(there / "measured")
    with pytest.raises(OSError, match="symbolic links"), held(here):
        pass
    assert (there / "measured").read_text() == "mine"


def test_one_process_at_a_time(tmp_path: Path) -> None:
    refused = pytest.raises(InputError, match="another process is writing into it")
    with held(tmp_path), refused, held(tmp_path):
        pass
    with held(tmp_path):
        pass


def test_of_two_that_name_one_new_file_the_second_is_told(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    told = pytest.raises(InputError, match=r"mine\.toml; it is there already; name a new file")
    with told, beside(path, new=True) as temporary:
        temporary.write_text("second")
        put_new(path, "first")
    assert path.read_text() == "first"
    assert names(tmp_path) == ["mine.toml"]


def test_what_killed_writers_left_is_removed_and_downloads_are_not(tmp_path: Path) -> None:
    for name in (".curve.csv.123-4.part", "film.part", ".film.mkv.part", "7-1.part"):
        (tmp_path / name).write_text("half")
    with held(tmp_path):
        pass
    assert set(names(tmp_path)) - {LOCK} == {".film.mkv.part", "7-1.part", "film.part"}
