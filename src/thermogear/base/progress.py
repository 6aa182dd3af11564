"""How long work tells how far it is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called as ``progress(stage, done, total)``."""


def silent(stage: str, done: int, total: int) -> None:
    """No progress wanted."""


def asking(alive: Callable[[], None], progress: Progress) -> Progress:
    """``progress`` that first asks whether to go on: ``alive`` raises to end the work."""

    def told(stage: str, done: int, total: int) -> None:
        alive()
        progress(stage, done, total)

    return told


def duration(seconds: float) -> str:
    """Seconds as a person says them."""
    if not seconds < 1e9:
        return "an unknown time"
    if seconds < 90.0:
        return f"{max(seconds, 0.1):.2g} s"
    return f"{seconds / 60.0:.2g} min" if seconds < 5400.0 else f"{seconds / 3600.0:.3g} h"
