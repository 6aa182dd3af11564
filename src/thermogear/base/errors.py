"""Errors and warnings: one line that names field, value, allowed range and a fix."""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Collection, Iterable, Sequence
from typing import Any


class ThermogearError(Exception):
    """Base of every error this package raises on purpose.

    >>> issubclass(InputError, ThermogearError)
    True
    """


class InputError(ThermogearError, ValueError):
    """A value the user gave is impossible.

    The message is one line: ``field: got VALUE; allowed RANGE; why; fix``. Parts
    that are not given are left out.

    >>> try:
    ...     Gear(0, 4e-3)
    ... except InputError as error:
    ...     print(error)
    teeth: got 0; allowed 5..2000
    """

    def __init__(
        self,
        field: str,
        got: object,
        *,
        allowed: str | None = None,
        why: str | None = None,
        fix: str | None = None,
    ) -> None:
        self.field = field
        self.got = got
        self.line: int | None = None
        self.allowed = allowed
        self.why = why
        self.fix = fix
        parts = (f"{field}: got {got}", f"allowed {allowed}" if allowed else "", why, fix)
        super().__init__("; ".join(part for part in parts if part).replace("\n", " "))

    @property
    def told(self) -> str:
        """The message, with the line of the file before it where that is known."""
        return str(self) if self.line is None else f"line {self.line}: {self}"

    def named(self, field: str) -> InputError:
        """The same error about ``field``, which whoever asked knows it by."""
        return type(self)(field, self.got, allowed=self.allowed, why=self.why, fix=self.fix)

    def under(self, prefix: str) -> InputError:
        """The same error with ``prefix.`` before its field: a part speaks for its whole."""
        return self.named(f"{prefix}.{self.field}")


def of_extra(module: str, extra: str, *, field: str, got: object, use: str) -> Any:
    """The package ``module`` that comes with the extra ``[extra]``.

    InputError about ``field`` where it is missing: ``use`` needs it, and how the checkout installs
    it. The name on the package index is not thermogear's, so it is never named.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(
            field,
            got,
            why=f"{use} needs {module.partition('.')[0]}",
            fix=f"in the checkout of thermogear: python -m pip install '.[{extra}]'",
        ) from error


class InputErrors(InputError):
    """Several impossible values of one file: ``errors``, one line each."""

    def __init__(self, errors: Sequence[InputError]) -> None:
        first = errors[0]
        super().__init__(first.field, first.got)
        self.errors = tuple(errors)
        self.args = ("\n".join(one.told for one in errors),)


class GeometryError(InputError):
    """A gear or a gear pair that cannot be made or cannot mesh.

    >>> try:
    ...     Gear(18, 4e-3, bore_radius=36e-3)
    ... except GeometryError as error:
    ...     print(error)
    bore_radius: got 36 mm; allowed < root radius 31 mm; the body must be a ring
    """


class ConvergenceError(ThermogearError):
    """An iteration did not settle; the message carries count, residual and tolerance."""


class ValidityWarning(UserWarning):
    """A value outside the range its source states; the result is an extrapolation.

    >>> issubclass(ValidityWarning, UserWarning)
    True
    """


class UnsealedWarning(ValidityWarning):
    """A stored file without its seal: nobody can say whether it is as it was written."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Advice for an unknown ``name``: the nearest known one, else the whole list.

    >>> nearest("stel", ["steel", "bronze"])
    "did you mean 'steel'?"
    """
    names = sorted(known)
    return meant(name, names, cutoff=0.5) or "known: " + ", ".join(names)


def meant(name: str, known: Iterable[str], *, cutoff: float) -> str | None:
    """Advice for an unknown ``name`` that is like a known one: alike by ``cutoff`` 0..1 or more."""
    close = difflib.get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return f"did you mean {close[0]!r}?" if close else None


def require_choice(field: str, value: str, known: Collection[str], why: str | None = None) -> None:
    """Refuse a word that is none of ``known``, with the nearest.

    >>> require_choice("end", "tip", ("tip", "root"))
    """
    if value not in known:
        allowed, fix = " | ".join(known), nearest(str(value), known)
        raise InputError(field, repr(value), allowed=allowed, why=why, fix=fix)


def printable(text: str) -> str:
    """``text`` that a terminal or a page only shows: what could rewrite them is replaced by "?".

    Replaced are control characters (escape sequences begin with one), line breaks, tabs, marks
    that turn the direction of reading, and all else that Unicode does not call printable.
    """
    return text if text.isprintable() else "".join(c if c.isprintable() else "?" for c in text)


def short(value: object) -> str:
    """A value as a message shows it: one line, at most 60 characters."""
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, dict):
        text = "a table"
    elif isinstance(value, int) and abs(value) >= 10**20:
        text = f"a whole number of about {int(value.bit_length() * 0.30103) + 1} digits"
    elif isinstance(value, int | float):
        text = f"{value:.15g}" if isinstance(value, float) else str(value)
    else:
        text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."
