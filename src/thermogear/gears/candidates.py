"""Which tooth pairs may carry load at a mesh phase, where they touch, and which teeth they are."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.contact import mirror_position
from thermogear.gears.corner import ContactPoint, contact_point
from thermogear.gears.deviations import Contacts
from thermogear.gears.pair import GearPair

_SAME_FRACTION = 11
"""Decimals of a mesh period beyond which two phases are at the same place: rounding of 2000."""


class MeshPoints(NamedTuple):
    """The candidates for contact at each mesh position, arrays (position, pair).

    ``broken``: whose tooth ends below the place where its flank would touch, 1 the wheel's, 2 the
    pinion's, as in :data:`~thermogear.base.vocabulary.EDGE_CONTACT`; None: no tooth does.
    ``shared``: over several mesh periods the points of each fraction of a phase that occurs, as of
    period 0, and which of them each position has; None: the positions are their own.
    """

    s: NDArray[np.float64]
    point: ContactPoint
    contacts: Contacts
    broken: NDArray[np.int8] | None = None
    shared: tuple[MeshPoints, NDArray[np.int64]] | None = None

    @property
    def fractions(self) -> tuple[MeshPoints, NDArray[np.int64]]:
        """What does not depend on the teeth's numbers, and the place of each position in it."""
        return self.shared or (self, np.arange(len(self.s)))


def mesh_points(
    pair: GearPair, phase: ArrayLike, flank: str = "drive", extended: bool = True
) -> MeshPoints:
    """All tooth pairs that may touch at ``phase`` (periods, one axis, any real numbers).

    Drive flanks: s_j = s_A + (frac(phase) + j) p_b, j = -1 .. ceil(contact ratio), one pair to
    each side of the path. Pair j of period N joins pinion tooth N - j. Back flanks run against
    it: s^c = K - s_j, K = 2 s_C + p_b/2 + r_b1 psi_1 - r_b2 psi_2, and join the wheel tooth that
    enters next.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> mesh_points(pair, [0.0, 0.5]).s.shape
    (2, 4)
    """
    phi = np.atleast_1d(np.asarray(phase, dtype=float))
    if phi.ndim != 1 or not np.all(np.isfinite(phi)):
        raise InputError("phase", f"shape {phi.shape}", allowed="one axis of finite numbers")
    require_choice("flank", flank, ("drive", "back"))
    period = np.floor(phi)
    if not np.any(period != period[:1]):
        return _at(pair, phi.tobytes(), flank, extended)
    fraction = phi - period
    _, first, place = np.unique(
        np.round(fraction, _SAME_FRACTION), return_index=True, return_inverse=True
    )
    once = _at(pair, fraction[first].tobytes(), flank, extended)
    return _renumbered(once, phi, place=place, period=period.astype(np.int64))


def _renumbered(
    once: MeshPoints, phi: Floats, *, place: NDArray[np.int64], period: NDArray[np.int64]
) -> MeshPoints:
    """The points of each fraction in the mesh periods in which it occurs."""
    point = ContactPoint(*(values[place] for values in once.point))
    pair, number, s = once.contacts.pair, period[:, None], once.s[place]
    contacts = Contacts(
        pair,
        s,
        point.pinion,
        point.wheel,
        (once.contacts.pinion_tooth[place] + number) % pair.pinion.teeth,
        (once.contacts.wheel_tooth[place] + number) % pair.wheel.teeth,
        once.contacts.flank,
        phi,
    )
    return MeshPoints(s, point, contacts, shared=(once, place))


@lru_cache(maxsize=32)
def _at(pair: GearPair, phases: bytes, flank: str, extended: bool) -> MeshPoints:
    """Remembered: a heat balance, a row of temperatures, a sweep ask for the same places."""
    phi = phase = np.frombuffer(phases)
    pitch, start = pair.base_pitch, pair.path.a
    ranks = np.arange(-1, int(np.ceil(pair.contact_ratio - 1e-12)) + 1)
    if flank == "drive":
        period = np.floor(phi)
        number = period[:, None] - ranks
        following = number
    else:
        mirror = (mirror_position(pair) - 2.0 * start) / pitch
        phi = mirror - phi
        period = np.floor(phi)
        number = ranks - period[:, None]
        following = number + 1
    s = start + ((phi - period)[:, None] + ranks) * pitch
    point = contact_point(pair, s, extended)
    contacts = Contacts(
        pair,
        s,
        point.pinion,
        point.wheel,
        np.mod(number, pair.pinion.teeth).astype(np.int64),
        np.mod(following, pair.wheel.teeth).astype(np.int64),
        flank,
        phase,
    )
    return MeshPoints(s, point, contacts)
