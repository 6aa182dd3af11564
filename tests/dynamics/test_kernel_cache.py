"""Compiled code is dropped when any of the kernels' sources has changed."""

from types import SimpleNamespace

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
