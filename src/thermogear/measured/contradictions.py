"""What a user says and what the lines say, where these cannot both be: told apart, in one line.

What is given is never called wrong alone: every other reading that would fit is told with it.
"""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.base.units import RPM
from thermogear.measured.record import Notice

NEAR = 0.1
"""A stated speed is nominal: motors slip by less."""
_WHOLE = 0.02  # of a number of teeth or of pulses


def of_teeth(given: int | None, found: Sequence[int]) -> Notice | None:
    """Teeth ``given`` that are none of those ``found`` on the mesh line (none: undecided)."""
    if given is None or not found or given in found:
        return None
    other = (
        "a gear of another mesh"
        if len(found) > 1
        else "the other gear of the mesh, whose sidebands do not show"
    )
    return Notice(
        "important",
        f"teeth given: {given}; teeth found: {_both(found)}. The {given} may be those of {other}, "
        f"or they are wrong; orders count the turns of a gear of {given}",
    )


def of_pulses(given: float | None, found: Sequence[int], mesh: float) -> Notice | None:
    """Pulses per turn ``given`` that put the mesh line at an order ``mesh`` of the tacho's shaft
    which is no number of teeth ``found`` (none: undecided)."""
    if given is None or not found or any(abs(mesh / z - 1.0) < _WHOLE for z in found):
        return None
    fitting = [(given * z / mesh, z) for z in found]
    ways = [
        f"{round(p)} would fit a tacho on the shaft of {z} teeth"
        for p, z in fitting
        if abs(p - round(p)) < _WHOLE * p
    ]
    other = f"the other gear, of {round(mesh)} teeth, or on "
    whole = len(found) == 1 and abs(mesh - round(mesh)) < _WHOLE
    ways.append(f"{given:g} fit one on the shaft of {other if whole else ''}no gear of this mesh")
    return Notice(
        "important",
        f"pulses per turn given: {given:g}; found: {_both(found)} teeth, and the mesh line at "
        f"order {mesh:.5g} of the tacho's shaft: {', '.join(ways)}",
    )


def of_speed(given: float | None, *, lowest: float, highest: float) -> Notice | None:
    """A speed ``given`` [rad/s] that the first shaft, from ``lowest`` to ``highest``, never has."""
    if given is None or (1.0 - NEAR) * lowest <= given <= (1.0 + NEAR) * highest:
        return None
    span = f"{lowest / RPM:.5g} to {highest / RPM:.5g} rpm over the record"
    return Notice(
        "important",
        f"speed given: {given / RPM:.6g} rpm; found: {span}. The speed given may be wrong, or "
        "teeth, pulses per turn or the rate are",
    )


def _both(teeth: Sequence[int]) -> str:
    return " and ".join(map(str, teeth))
