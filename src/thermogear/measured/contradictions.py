"""What a user says and what the lines say, where these cannot both be: told apart, in one line.

What is given is never called wrong alone: every other reading that would fit is told with it.
"""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.measured.record import Notice

NEAR = 0.1
"""A stated speed is nominal: motors slip by less."""
_WHOLE = 0.02  # of a number of teeth or of pulses


def of_teeth(given: int | None, found: Sequence[int]) -> Notice | None:
    """Teeth ``given`` that are none of those ``found`` on the mesh line (none: undecided)."""
    if given is None or not found or given in found:
        return None
    return Notice.of("teeth_contradicted", given=given, found=found)


def of_pulses(
    given: float | None, found: Sequence[int], mesh: float, *, teeth: int | None
) -> Notice | None:
    """Pulses per turn ``given`` that put the mesh line at an order ``mesh`` of the tacho's shaft
    which is no number of teeth ``found``, or, where these are undecided, given."""
    known = list(found) or ([teeth] if teeth else [])
    if given is None or not known or any(abs(mesh / z - 1.0) < _WHOLE for z in known):
        return None
    pulses = {z: given * z / mesh for z in known}
    fitting = {z: round(p) for z, p in pulses.items() if abs(p - round(p)) < _WHOLE * p}
    whole = len(known) == 1 and abs(mesh - round(mesh)) < _WHOLE
    return Notice.of(
        "pulses_contradict_teeth",
        given=given,
        teeth_given=None if found else teeth,
        teeth_found=found or None,
        order=mesh,
        fitting=list(fitting.values()) or None,
        of_teeth=list(fitting) or None,
        mate=round(mesh) if whole else None,
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
    fits = would and abs(pulses * own / given / would - 1) < NEAR
    return Notice.of(
        "pulses_contradict_speed",
        given=pulses,
        speed_found=own,
        speed_given=given,
        fitting=would if fits else None,
    )


def of_speed(given: float | None, *, lowest: float, highest: float) -> Notice | None:
    """A speed ``given`` [rad/s] that the first shaft, from ``lowest`` to ``highest``, never has."""
    if given is None or (1.0 - NEAR) * lowest <= given <= (1.0 + NEAR) * highest:
        return None
    return Notice.of("speed_contradicted", given=given, lowest=lowest, highest=highest)


def of_mate(teeth: int, *, speed: float, shaft: float, found: Sequence[int]) -> Notice | None:
    """Which gear turns at the ``speed`` [rad/s] given, where that of the ``teeth`` given turns at
    ``shaft`` [rad/s]; None where none of the teeth ``found`` on the same mesh line turns so, or
    the gear of the teeth given does.

    >>> of_mate(71, speed=129.12, shaft=52.74, found=[29, 71]).data["mate"]
    29
    """
    if abs(shaft / speed - 1.0) <= NEAR:
        return None
    others = {z: shaft * teeth / z for z in found if z != teeth}
    mate = min(others, key=lambda z: abs(others[z] / speed - 1.0), default=None)
    if mate is None or abs(others[mate] / speed - 1.0) > NEAR:
        return None
    return Notice.of(
        "speed_is_of_mate",
        teeth=teeth,
        speed=speed,
        mate=mate,
        mate_speed=others[mate],
        teeth_speed=shaft,
    )


def of_line(given: float, *, found: float, weight: float) -> Notice | None:
    """A mesh line that teeth and speed ``given`` place [cycles/sample], and is read there, where
    nearly all the ``weight`` has another."""
    if abs(found / given - 1.0) <= NEAR:
        return None
    return Notice.of(
        "mesh_line_contradicted", given=given, found=found, weight=weight, ratio=found / given
    )
