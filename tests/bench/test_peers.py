"""A peer that cannot be used is named with its reason; one that gives up counts for nothing."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

BENCH = Path(__file__).parents[2] / "bench"
SOLVERS = """
import numba
import numpy as np

lsoda_sig = numba.types.void(
    numba.types.double, *[numba.types.CPointer(numba.types.double)] * 3
)


@numba.njit
def lsoda(address, start, times, data, rtol=1e-3, atol=1e-6, mxstep=10000):
    return np.ones((2, 2)), mxstep > 10**8 and data[0] < 1.0
"""


@pytest.mark.parametrize(
    ("package", "told"),
    [
        ("raise OSError('libdop853.so: cannot open')", "libdop853.so: cannot open"),
        ("raise ImportError('no driver')", "no driver"),
    ],
)
def test_a_package_without_its_library_is_missing(
    package: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    peers = loaded(package, tmp_path, monkeypatch)
    with pytest.raises(peers.Missing) as caught:
        peers._numbalsoda("lsoda")
    assert str(caught.value) == f"installed, but it cannot be loaded: {told}"


def test_a_solver_takes_all_its_steps_or_has_no_rate(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    peers = loaded(SOLVERS, tmp_path, monkeypatch)
    from points import Points

    half = np.full(2, 0.5)
    run = peers._numbalsoda("lsoda")
    assert (run(Points(*[half] * 5, np.zeros((2, 2))), 2) == 1.0).all()
    with pytest.raises(RuntimeError, match=r"^numbalsoda lsoda: an end was not reached$"):
        run(Points(4.0 * half, *[half] * 4, np.zeros((2, 2))), 2)


def loaded(package: str, folder: Path, monkeypatch: pytest.MonkeyPatch):
    """The module of the peers where numbalsoda is ``package``."""
    (folder / "numbalsoda.py").write_text(package, "utf-8")
    monkeypatch.syspath_prepend(str(BENCH))
    monkeypatch.syspath_prepend(str(folder))
    for name in ("peers", "points", "numbalsoda"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    import peers

    return peers
