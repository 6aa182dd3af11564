"""Machine code of kernels that is stored on disk; damaged code is compiled anew.

numba keeps an index and data files for each kernel. Where one of them is empty or cut, after a
full disk or a kill, numba 0.68 hands on whatever reading it raises, at every later call.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core.caching import IndexDataCacheFile

Kernel = TypeVar("Kernel")
Function = TypeVar("Function", bound=Callable[..., object])


class KernelCacheWarning(UserWarning):
    """Stored machine code could not be read; it is compiled and stored anew."""


class RebuiltFile(IndexDataCacheFile):
    """Index and data of one kernel; what cannot be read counts as not stored, and is said."""

    def _load_index(self) -> dict[Any, str]:
        try:
            index: dict[Any, str] = super()._load_index()  # type: ignore[no-untyped-call]
        except Exception as error:  # a pickle of anything may raise anything
            self._say(error)
            return {}
        return index

    def _load_data(self, name: str) -> Any:
        try:
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


def rebuilt(kernel: Kernel) -> Kernel:
    """A function compiled with ``cache=True``, whose damaged code is compiled anew."""
    file = getattr(getattr(kernel, "_cache", None), "_cache_file", None)
    if type(file) is IndexDataCacheFile:
        file.__class__ = RebuiltFile
    return kernel


def compiled(function: Function) -> Function:
    """numba's decorator with a type; no fast math, so that results do not depend on the lane.

    A division by zero gives inf or nan, as numpy's: to look for one costs time at every division.
    """
    return rebuilt(cast(Function, numba.njit(cache=True, error_model="numpy")(function)))
