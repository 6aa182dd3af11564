"""Every friction law side by side along the path of contact, with its range and the regime."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import chain

import numpy as np

from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import REGIMES, label
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT
from thermogear.gears.contact import path_of_contact
from thermogear.heat.contact_state import ContactState
from thermogear.heat.film import FILM_UNCERTAINTY, regime, regime_shares
from thermogear.heat.friction import LAWS, ConstantDry, FrictionLaw, laws_together
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.model import MeshModel
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Notice, Result
from thermogear.study.declared import Friction, declared
from thermogear.study.notices import turn_notices


def friction_path(case: GearCase, model: MeshModel, positions: int) -> FrictionPath:
    """The lubricated contact of every operating point of ``case``, hot."""
    HOT.require_settled(case, model, np.s_[:])
    hot = HotPair(case.pair, case.operating_of(model), model)
    s = path_of_contact(case.pair, positions)
    return FrictionPath(elastic_pair(hot, case.deviations), s).checked()


def laws_beside(model: MeshModel) -> dict[str, FrictionLaw]:
    """Every law by its name, the model's own in its place and in words; dry as the model has it."""
    dry, own = ConstantDry(model.dry_coefficient), model.law
    laws = LAWS | {dry.name: dry, own.name: own}
    words = str(model.choices()["friction"])
    return {words if name == own.name else name: law for name, law in laws.items()}


@declared(Friction)
def friction_survey(case: GearCase, *, progress: Progress = silent) -> Result:
    """|mu| by every law over the path of contact at every operating point, hot.

    Variables over (law, operating, path_position): ``friction_coefficient`` (nan where a law has
    no value for this oil or roughness), ``outside_range`` 1 where the contact leaves the range
    that the law's source gives; over (operating, path_position) ``film_parameter``,
    ``film_thickness``, ``regime``; over (operating, regime_name) ``regime_share`` of the path;
    ``mean_friction`` weighted by sliding power, over (law, operating). The first model of the
    case decides load shares and temperatures.
    """
    model = case.models[0]
    progress("friction laws", 0, 1)
    path = friction_path(case, model, case.path_positions)
    state = path.state
    shape = (case.stated.speed.size, path.s.size)
    laws = laws_beside(model)
    together = laws_together(state, tuple(laws.values()))
    mu = np.broadcast_to(together.coefficient, (len(laws), *shape))
    outside = np.broadcast_to(together.outside, mu.shape).astype(np.int8)
    words = [
        {
            "law": name,
            "regime": law.regime,
            "source": law.source,
            "range": range_in_words(law),
            "missing": reason,
        }
        for (name, law), reason in zip(laws.items(), together.missing, strict=True)
    ]
    along = ("operating", "path_position")
    weight = path.line_load * np.abs(np.subtract(*path.velocities))
    total = np.trapezoid(np.broadcast_to(weight, shape), path.s, axis=-1)
    mean = np.trapezoid(mu * weight, path.s, axis=-1)
    mean = np.divide(mean, total, out=np.full_like(mean, np.nan), where=total > 0.0)
    film = np.broadcast_to(path.film_parameter, shape)
    data = label(
        {
            "friction_coefficient": (("law", *along), mu, "1", "friction coefficient by the law"),
            "outside_range": (
                ("law", *along),
                outside,
                "1",
                "1 where the contact leaves the law's range",
            ),
            "mean_friction": (
                ("law", "operating"),
                mean,
                "1",
                "friction coefficient, mean by sliding power",
            ),
            "film_parameter": (along, film),
            "film_thickness": (along, np.broadcast_to(path.film, shape)),
            "regime": (along, regime(film)),
            "regime_share": (
                ("operating", "regime_name"),
                regime_shares(film),
                "1",
                "share of the path",
            ),
        },
        {
            "law": list(laws),
            "regime_name": list(REGIMES),
            "path_position": path.s,
            "pinion_speed": ("operating", case.stated.speed),
            "pinion_torque": ("operating", case.stated.torque),
        },
        {
            "path_points": json.dumps({k.upper(): v for k, v in case.pair.path._asdict().items()}),
            "chosen": model.choices()["friction"],
            "bundle": model.name,
        },
    )
    return Result.of(
        Friction.kind,
        f"Friction laws: {case.title}",
        {"laws": data},
        chain(turn_notices(case), _notices(state, words)),
        **case.provenance,
        laws=words,
    )


def range_in_words(law: FrictionLaw) -> str:
    """A law's range in the units a gear engineer reads; empty where its source gives none."""
    shown = {
        "roughness": (1e6, "um", "roughness Ra"),
        "viscosity": (1e3, "mPa s", "viscosity"),
        "film_parameter": (1.0, "", "film parameter"),
    }
    parts = []
    for name, (low, high) in law.ranges.items():
        scale, unit, text = shown.get(name, (1.0, "", name))
        ends = (
            f"{scale * low:g} .. {scale * high:g}" if np.isfinite(high) else f">= {scale * low:g}"
        )
        parts.append(f"{text} {ends} {unit}".strip())
    return "; ".join(parts)


def _notices(state: ContactState, words: list[dict[str, str]]) -> Iterator[Notice]:
    yield Notice.of("film_uncertain", uncertainty=FILM_UNCERTAINTY)
    yield Notice.of("friction_at_pitch_point")
    for one in words:
        if one["missing"]:
            yield Notice.of("law_without_value", about=one["law"], reason=one["missing"])
    if float(np.max(np.asarray(state.sum_speed))) == 0.0:
        yield Notice.of("pair_at_rest")
