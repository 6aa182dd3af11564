"""No stale machine code: numba knows a cached function by its own file alone.

The kernels call one another across files, so a change in one of them has to drop the code of all.
"""

from __future__ import annotations

import hashlib
import os
from contextlib import suppress
from pathlib import Path

from numba import njit

from thermogear.base.kernel_cache import rebuilt

STAMP = "thermogear-kernels.sha256"


@rebuilt
@njit(cache=True)
def _anchor() -> int:
    """Never called: it knows where numba keeps the code of this folder."""
    return 0


def digest(folder: Path) -> str:
    """One hash of all sources of a folder."""
    content = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        content.update(source.read_bytes())
    return content.hexdigest()


def drop_stale(sources: Path | None = None, cache: Path | None = None) -> bool:
    """Remove cached kernels whose sources have changed; whether there were any.

    ``sources`` and ``cache`` default to this folder and to where numba keeps its code. A folder
    that cannot be written is left as it is: then numba cannot have written there either.
    """
    sources = Path(__file__).parent if sources is None else sources
    if cache is None:
        where = _anchor.stats.cache_path
        if where is None:
            return False
        cache = Path(where)
    stamp = cache / STAMP
    now = digest(sources)
    with suppress(OSError):
        if stamp.is_file() and stamp.read_text(encoding="ascii") == now:
            return False
    dropped = False
    with suppress(OSError):
        for index in cache.glob("*.nbi"):
            index.unlink(missing_ok=True)
            dropped = True
        cache.mkdir(parents=True, exist_ok=True)
        draft = cache / f"{STAMP}.{os.getpid()}"
        draft.write_text(now, encoding="ascii")
        draft.replace(stamp)
    return dropped
