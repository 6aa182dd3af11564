"""What a user says and what the lines say, where these cannot both be: told apart, in one line.

What is given is never called wrong alone: every other reading that would fit is told with it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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


def of_pulses(
    given: float | None, found: Sequence[int], mesh: float, *, teeth: int | None
) -> Notice | None:
    """Pulses per turn ``given`` that put the mesh line at an order ``mesh`` of the tacho's shaft
    which is no number of teeth ``found``, or, where these are undecided, given."""
    known = list(found) or ([teeth] if teeth else [])
    if given is None or not known or any(abs(mesh / z - 1.0) < _WHOLE for z in known):
        return None
    said = f"found: {_both(known)} teeth, and" if found else f"teeth given: {teeth}; found:"
    fitting = [(given * z / mesh, z) for z in known]
    ways = [
        f"{round(p)} would fit a tacho on the shaft of {z} teeth"
        for p, z in fitting
        if abs(p - round(p)) < _WHOLE * p
    ]
    other = f"the other gear, of {round(mesh)} teeth, or on "
    whole = len(known) == 1 and abs(mesh - round(mesh)) < _WHOLE
    fits = f"{given:g} {'fits' if given == 1.0 else 'fit'} one on the shaft of"
    ways.append(f"{fits} {other if whole else ''}no gear of this mesh")
    return Notice(
        "important",
        f"pulses per turn given: {given:g}; {said} the mesh line at order {mesh:.5g} of the "
        f"tacho's shaft: {', '.join(ways)}",
    )


def of_tacho_speed(
    *, pulses: float | None, given: float | None, own: float, orders: Sequence[float]
) -> Notice | None:
    """A speed ``given`` [rad/s] that no shaft has: the tacho's turns at ``own`` [rad/s] with the
    ``pulses`` per turn given, others ``orders`` times as fast (1: itself)."""
    if pulses is None or given is None:
        return None
    shafts = [own * order for order in orders]
    if any(abs(given / one - 1.0) <= NEAR for one in shafts):
        return None
    would = round(pulses * own / given)
    ways = [f"{would} would fit"] if would and abs(pulses * own / given / would - 1) < NEAR else []
    ways += ["the speed given may be wrong or that of another shaft, or the rate is wrong"]
    return Notice(
        "important",
        f"pulses per turn given: {pulses:g}, with which the tacho's shaft turns at "
        f"{own / RPM:.6g} rpm; speed given: {given / RPM:.6g} rpm: {', '.join(ways)}",
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


def of_mate(teeth: int, *, speed: float, shaft: float, found: Sequence[int]) -> tuple[str, str]:
    """Which gear turns at the ``speed`` [rad/s] given, where that of the ``teeth`` given turns at
    ``shaft`` [rad/s], and what to state instead; both empty where none of the teeth ``found`` on
    the same mesh line turns so, or the gear of the teeth given does.

    >>> of_mate(71, speed=129.12, shaft=52.74, found=[29, 71])[1]
    'give teeth and speed of one gear: --teeth 29 --speed 1233 or --teeth 71 --speed 503.63'
    """
    if abs(shaft / speed - 1.0) <= NEAR:
        return "", ""
    others = [(z, shaft * teeth / z) for z in found if z != teeth]
    fitting = [(abs(own / speed - 1.0), z, own) for z, own in others]
    off, mate, own = min(fitting, default=(np.inf, 0, 0.0))
    if off > NEAR:
        return "", ""
    rpm = f"{own / RPM:.5g}", f"{shaft / RPM:.5g}"
    text = (
        f"teeth given: {teeth}; speed given: {speed / RPM:.6g} rpm; found: that is the speed of "
        f"the gear of {mate} teeth, which turns at {rpm[0]} rpm; the gear of {teeth} teeth turns "
        f"at {rpm[1]} rpm"
    )
    ways = f"--teeth {mate} --speed {rpm[0]} or --teeth {teeth} --speed {rpm[1]}"
    return text, f"give teeth and speed of one gear: {ways}"


def of_line(given: float, *, found: float, weight: float) -> Notice | None:
    """A mesh line that teeth and speed ``given`` place [cycles/sample], and is read there, where
    nearly all the ``weight`` has another."""
    if abs(found / given - 1.0) <= NEAR:
        return None
    return Notice(
        "important",
        f"teeth and speed given put the mesh line at {given:.6f} cycles/sample, where it is read; "
        f"found: {found:.6f} (weight {weight:.4g}). {found / given:.4g} times the speed given "
        "would fit",
    )


def _both(teeth: Sequence[int]) -> str:
    return " and ".join(map(str, teeth))
