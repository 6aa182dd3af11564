"""Compiled code is dropped when its sources have changed, and made anew where it is damaged."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from thermogear.base.kernel_cache import KernelCacheWarning
from thermogear.dynamics.kernels import fresh
from thermogear.dynamics.kernels.fresh import STAMP, digest, drop_stale


def test_changed_sources_drop_the_compiled_code(tmp_path):
    sources, cache = tmp_path / "sources", tmp_path / "cache"
    sources.mkdir()
    cache.mkdir()
    (sources / "inner.py").write_text("a = 1\n")
    (sources / "outer.py").write_text("import inner\n")
    drop_stale(sources, cache)
    assert (cache / STAMP).read_text() == digest(sources)
    (cache / "outer.nbi").write_bytes(b"code")
    assert not drop_stale(sources, cache)  # nothing has changed
    assert (cache / "outer.nbi").exists()
    (sources / "inner.py").write_text("a = 2\n")
    assert drop_stale(sources, cache)  # the caller's own file is as it was
    assert not (cache / "outer.nbi").exists()
    assert not drop_stale(sources, cache)


def test_where_numba_keeps_its_code_is_where_it_is_dropped(tmp_path, monkeypatch):
    for place, dropped in ((str(tmp_path), True), (None, False)):
        stats = SimpleNamespace(cache_path=place)
        monkeypatch.setattr(fresh, "_anchor", SimpleNamespace(stats=stats))
        (tmp_path / "kernel.nbi").write_bytes(b"code")
        assert drop_stale() is dropped
        assert (tmp_path / "kernel.nbi").exists() is not dropped


KERNEL = """
from thermogear.base.kernel_cache import compiled

@compiled
def twice(x):
    return 2.0 * x
"""


def loaded(path: Path) -> Callable[[float], float]:
    """The kernel of a module that is loaded anew, as a new process has it."""
    spec = importlib.util.spec_from_file_location("a_kernel", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.twice


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_damaged_code_is_compiled_anew_and_stored(ending: str, tmp_path: Path) -> None:
    path = tmp_path / "a_kernel.py"
    path.write_text(KERNEL)
    assert loaded(path)(1.5) == 3.0
    (stored,) = tmp_path.rglob(f"*.{ending}")
    whole = stored.read_bytes()
    for left in (0, 1, len(whole) // 2, len(whole) - 1):
        stored.write_bytes(whole[:left])
        with pytest.warns(KernelCacheWarning, match=r"is damaged \(\w+\); it is compiled anew$"):
            assert loaded(path)(1.5) == 3.0
        assert stored.stat().st_size > 0.9 * len(whole)
        assert loaded(path)(1.5) == 3.0  # without a warning


def test_a_kernel_divides_by_zero_as_numpy_does(tmp_path: Path) -> None:
    path = tmp_path / "a_kernel.py"
    path.write_text(KERNEL.replace("2.0 * x", "2.0 / x"))
    assert [loaded(path)(value) for value in (0.5, 0.0, -0.0)] == [4.0, np.inf, -np.inf]
