"""What a user says and what the lines say, where these cannot both be: told apart, in one line.

What is given is never called wrong alone: every other reading that would fit is told with it.
"""

from __future__ import annotations

from collections.abc import Sequence

from thermogear.measured.gearing import NEAR, Gearing
from thermogear.measured.record import Notice

_WHOLE = 0.02  # of a number of teeth or of pulses


def of_pulses(given: float | None, *, mesh: float, teeth: int | None) -> list[Notice]:
    """Pulses per turn ``given`` that put the mesh line at an order ``mesh`` of the tacho's shaft
    which is not the number of ``teeth`` given."""
    if given is None or teeth is None or abs(mesh / teeth - 1.0) < _WHOLE:
        return []
    pulses = given * teeth / mesh
    fits = abs(pulses - round(pulses)) < _WHOLE * pulses
    return [
        Notice.of(
            "pulses_contradict_teeth",
            given=given,
            teeth=teeth,
            order=mesh,
            fitting=round(pulses) if fits else None,
            mate=round(mesh) if abs(mesh - round(mesh)) < _WHOLE else None,
        )
    ]


def of_tacho_speed(
    *, pulses: float | None, given: float | None, own: float, orders: Sequence[float]
) -> list[Notice]:
    """A speed ``given`` [rad/s] that no shaft has: the tacho's turns at ``own`` [rad/s] with the
    ``pulses`` per turn given, others ``orders`` times as fast (1: itself)."""
    if pulses is None or given is None:
        return []
    shafts = [own * order for order in orders]
    if any(abs(given / one - 1.0) <= NEAR for one in shafts):
        return []
    would = round(pulses * own / given)
    fits = would and abs(pulses * own / given / would - 1) < NEAR
    return [
        Notice.of(
            "pulses_contradict_speed",
            given=pulses,
            speed_found=own,
            speed_given=given,
            fitting=would if fits else None,
        )
    ]


def of_speed(given: float | None, *, lowest: float, highest: float) -> list[Notice]:
    """A speed ``given`` [rad/s] that the first shaft, from ``lowest`` to ``highest``, never has."""
    if given is None or (1.0 - NEAR) * lowest <= given <= (1.0 + NEAR) * highest:
        return []
    return [Notice.of("speed_contradicted", given=given, lowest=lowest, highest=highest)]


def of_line(near: Gearing) -> list[Notice]:
    """A mesh line that teeth and speed given place, and is read there, where it is the second or
    third harmonic of a line as clear [cycles/sample]."""
    if not near.rank_of:
        return []
    given, clearest = near.mesh_frequency, near.mesh_frequency / near.rank_of
    return [
        Notice.of("mesh_line_contradicted", given=given, found=clearest, ratio=clearest / given)
    ]
