"""Model beside finite elements: stiffness and load shares of a pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from finite_elements.stiffness import pair_stiffness
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.gears.deviations import FlankShape
from thermogear.gears.loaded import LoadedModel, loaded_contact
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density


def inner_phases(pair: GearPair, each: int = 3) -> Floats:
    """Mesh phases in the middles of ``each`` equal parts of both kinds of contact.

    First where one pair more than floor(contact ratio) touches, then where not.
    """
    if each < 1:
        raise InputError("positions", each, allowed=">= 1 in each kind of contact")
    more = pair.contact_ratio - np.floor(pair.contact_ratio)
    part = (np.arange(each) + 0.5) / each
    return np.concatenate([more * part, more + (1.0 - more) * part])


@dataclass(frozen=True, eq=False, kw_only=True)
class StiffnessCheck:
    """Deflection [m], secant stiffness [N/m] and shares of the model and of the finite elements.

    Arrays (position,) and (position, pair), pair 0 not yet entered, pair 1 the last that did;
    ``phase`` in periods from A; deflections from the touch of perfect involutes.
    """

    phase: Floats
    model_deflection: Floats
    finite_deflection: Floats
    model_share: Floats
    finite_share: Floats
    face_width: float
    line_load: float

    @property
    def model(self) -> Floats:
        """Secant stiffness [N/m] of the model, (position,)."""
        return self.line_load * self.face_width / self.model_deflection

    @property
    def finite(self) -> Floats:
        """Secant stiffness [N/m] of the finite elements, (position,)."""
        return self.line_load * self.face_width / self.finite_deflection

    @property
    def pairs(self) -> Floats:
        """Number of pairs that carry, (position,)."""
        return np.asarray((self.finite_share > 0.0).sum(axis=-1))

    @property
    def difference(self) -> Floats:
        """Model over finite elements minus 1, of the stiffness, (position,)."""
        return self.model / self.finite - 1.0

    @property
    def share_difference(self) -> Floats:
        """Model's share minus the finite elements', (position, pair)."""
        return self.model_share - self.finite_share

    @property
    def peak_to_peak(self) -> tuple[float, float]:
        """Greatest minus least deflection [m] of the model and of the finite elements."""
        return float(np.ptp(self.model_deflection)), float(np.ptp(self.finite_deflection))

    @property
    def error(self) -> Floats:
        """Model's deflection minus the finite elements' [m], (position,)."""
        return self.model_deflection - self.finite_deflection

    @property
    def worst(self) -> int:
        """The position with the greatest error of the deflection."""
        return int(np.argmax(np.abs(self.error)))

    @property
    def worst_share(self) -> float:
        """The greatest difference in a share."""
        return float(np.max(np.abs(self.share_difference)))


def check_stiffness(
    pair: GearPair,
    normal_force: float,
    phase: ArrayLike | None = None,
    density: Density | None = None,
    near: str = "strain",
    *,
    deviations: Sequence[FlankShape] = (),
    corners: bool = False,
    model: LoadedModel | None = None,
) -> StiffnessCheck:
    """The loaded contact (bores clamped) beside finite elements of the same pair.

    normal_force: F_n [N] > 0; phase: positions in periods from A, by default
    :func:`inner_phases`; density, near: of the finite elements; deviations: of the flanks;
    corners: sharp tip corners touch beyond A and E, in both; model: other choices of the loaded
    contact. Raises as :func:`~finite_elements.stiffness.pair_stiffness`.
    """
    phi = inner_phases(pair) if phase is None else np.atleast_1d(np.asarray(phase, dtype=float))
    finite = pair_stiffness(
        pair, normal_force, phi, density, near, deviations=deviations, corners=corners
    )
    clamped = replace(model or LoadedModel(), body="bore_clamped", extended=corners)
    loaded = loaded_contact(pair, normal_force, phi, deviations=deviations, model=clamped)
    return StiffnessCheck(
        phase=phi,
        model_deflection=loaded.transmission_error.to_numpy(),
        finite_deflection=finite.deflection,
        model_share=loaded.load_share.to_numpy(),
        finite_share=finite.share,
        face_width=pair.face_width,
        line_load=normal_force / pair.face_width,
    )
