"""Machine code of kernels that is stored on disk; damaged code is compiled anew.

numba keeps an index and data files for each kernel. Where one of them is empty or cut, after a
full disk or a kill, numba 0.68 hands on whatever reading it raises, at every later call; a changed
bit in machine code it runs. So each file ends with the SHA-256 of what is before: pickles are read
up to their own end, and numba does not see it.
"""

from __future__ import annotations

import hashlib
import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from numba.core.caching import IndexDataCacheFile

Kernel = TypeVar("Kernel")
_DIGEST = hashlib.sha256().digest_size


class KernelCacheWarning(UserWarning):
    """Stored machine code could not be read; it is compiled and stored anew."""


class RebuiltFile(IndexDataCacheFile):
    """Index and data of one kernel; what is damaged counts as not stored, and is said."""

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        whole = io.BytesIO()
        yield whole
        with super()._open_for_write(filepath) as file:  # type: ignore[no-untyped-call]
            file.write(whole.getvalue() + hashlib.sha256(whole.getvalue()).digest())

    def _load_index(self) -> dict[Any, str]:
        try:
            _require_whole(self._index_path)
            index: dict[Any, str] = super()._load_index()  # type: ignore[no-untyped-call]
        except FileNotFoundError:
            return {}
        except Exception as error:  # a pickle of anything may raise anything
            self._say(error)
            return {}
        return index

    def _load_data(self, name: str) -> Any:
        try:
            _require_whole(self._data_path(name))  # type: ignore[no-untyped-call]
            return super()._load_data(name)  # type: ignore[no-untyped-call]
        except FileNotFoundError:
            raise
        except Exception as error:
            self._say(error)
            raise OSError(name) from error  # for numba: not stored

    def _say(self, error: Exception) -> None:
        warnings.warn(
            f"machine code in {self._cache_path} is damaged ({type(error).__name__}); "
            "it is compiled anew",
            KernelCacheWarning,
            stacklevel=2,
        )


def _require_whole(path: str) -> None:
    raw = Path(path).read_bytes()
    if hashlib.sha256(raw[:-_DIGEST]).digest() != raw[-_DIGEST:]:
        raise ValueError(path)


def rebuilt(kernel: Kernel) -> Kernel:
    """A function compiled with ``cache=True``, whose damaged code is compiled anew."""
    file = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
    if type(file) is IndexDataCacheFile:
        file.__class__ = RebuiltFile
        # a name of its own: an index that numba itself wrote has no digest
        file._index_path = file._index_path.removesuffix(".nbi") + ".sealed.nbi"
    return kernel
