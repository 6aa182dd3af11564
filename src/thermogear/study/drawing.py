"""Both gears of a case in mesh, cold and hot, as numbers to draw."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from thermogear.base.arrays import DataArray, Dataset
from thermogear.base.display import kind_in_words
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import UNDEFORMED, is_known
from thermogear.case.case import GearCase, gear_case
from thermogear.case.one_point import counted, named
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.case.thermal_state import UNDEFORMED as COLD
from thermogear.mesh.drawing import PHASES, drawn_gears
from thermogear.mesh.model import MeshModel
from thermogear.results.result import Notice, Result
from thermogear.study.declared import fault_notices, mean_tooth_notices

KIND = "drawing"
MOST = 6
"""Operating points that a run stores a drawing of, at most."""


def drawing(
    case: GearCase,
    *,
    operating: int | None = None,
    bundle: str | None = None,
    state: StateLike = HOT,
    phase: float | None = None,
    fineness: int = 1,
) -> Result:
    """Both gears in mesh at one operating point, as drawn and in a ``state`` of heat.

    ``operating`` counts from 1 in the order of the file (speeds times torques, torque the fast
    one), the first if left out; ``bundle`` as in the case, the first if left out; ``state`` "hot",
    "computed", or the gears' temperature [K]; ``phase`` 0..1 of the mesh period, :data:`PHASES` of
    it if left out; ``fineness`` times as many points of the outlines.
    The one group ``drawing`` is that of :func:`thermogear.mesh.drawing.drawn_gears`. Raises
    InputError where there is no such point, and where its temperatures did not settle.
    """
    case, hot = gear_case(case), ThermalState.of(state)
    if phase is not None and not 0.0 <= phase <= 1.0:
        raise InputError("phase", f"{phase:g}", allowed="0..1", fix="a part of one mesh period")
    names = [model.name for model in case.models]
    model = dict(zip(names, case.models, strict=True))[named("bundle", bundle, names)]
    most = len(case.speeds) * len(case.torques)
    here = counted("operating", 1 if operating is None else operating, most=most)
    hot.require_settled(case, model, here)
    data = _drawn(case, model, hot, [here], PHASES if phase is None else (phase,), fineness)
    return Result.of(
        KIND,
        f"The gears in mesh: {case.title}",
        {"drawing": data},
        [*_flank_notices(case), *_notices(data)],
        **case.provenance,
        state=hot.words,
    )


def drawn_points(case: GearCase, status: DataArray) -> Dataset | None:
    """The drawing of a run: at most :data:`MOST` operating points whose hot ``status`` is known.

    None where there is none.
    """
    known = np.flatnonzero(is_known(status.values))
    if not known.size:
        return None
    places = known[np.unique(np.linspace(0, known.size - 1, min(MOST, known.size)).round())
                   .astype(int)]  # fmt: skip
    return _drawn(case, case.models[0], HOT, [int(place) for place in places], PHASES, 1)


def _drawn(
    case: GearCase,
    model: MeshModel,
    hot: ThermalState,
    places: Sequence[int],
    phases: Sequence[float],
    fineness: int,
) -> Dataset:
    states = {
        name: replace(state.operating(case, model), housing=case.housing).part(np.array(places))
        for name, state in ((UNDEFORMED, COLD), ("hot", hot))
    }
    return drawn_gears(
        case.pair,
        states,
        model,
        deviations=case.deviations,
        phases=phases,
        fineness=fineness,
    )


def _flank_notices(case: GearCase) -> Iterator[Notice]:
    """Which of the case's deviations and teeth are drawn."""
    yield from fault_notices(case.mean_tooth())
    yield from mean_tooth_notices(case, case.mean_tooth())
    if case.file.gears.part == "nominal":
        others = {kind_in_words(d) for d in case.sound().all_deviations if d not in case.deviations}
        if others:
            yield Notice.of("nominal_flanks_drawn", deviations=sorted(others))


def _notices(data: Dataset) -> Iterator[Notice]:
    yield Notice.of("backlash_off_all_flanks")
    if float(data["back_gap"].min()) <= 0.0:
        yield Notice.of("no_backlash_left")
    if float(data["tip_clearance"].min()) <= 0.0:
        yield Notice.of("no_tip_clearance_left")
    if data.attrs["not_drawn"]:
        yield Notice.of("deviations_not_drawn", deviations=data.attrs["not_drawn"])
