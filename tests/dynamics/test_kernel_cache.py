"""Compiled code is dropped when any of the kernels' sources has changed."""

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
