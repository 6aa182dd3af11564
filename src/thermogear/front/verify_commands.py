"""``thermogear verify``: models against finite elements; a group for the main one to register."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.front import delivery
from thermogear.results.files import json_text

if TYPE_CHECKING:
    from thermogear.verify.checks import GrowthCheck, StiffnessCheck
    from thermogear.verify.pairs import CheckedPair

_near = click.option(
    "--near",
    default="strain",
    show_default=True,
    help="Plane state around the contact: strain as far as the tooth's axis, or stress.",
)
_refine = click.option(
    "--refine",
    type=click.IntRange(1, 8),
    default=1,
    show_default=True,
    help="Split every element of the meshes into so many each way.",
)

_CORNER_PHASES = tuple((i + 0.5) / 12 for i in range(12))
"""Positions of a whole period, where tips touch beyond the path of contact too."""
STIFFNESS_NOTES = (
    "both gears whole, plane stress, bores clamped",
    "corner contact off in both, unless said",
)


@click.group()
def verify() -> None:
    """Hold the models against finite elements (extra [fe])."""


@verify.command()
@delivery.case
@delivery.overrides
@click.option(
    "--torque",
    type=float,
    metavar="NM",
    help="Pinion torque; the case's greatest one if left out.",
)
@click.option(
    "--positions",
    type=click.IntRange(1, 50),
    default=3,
    show_default=True,
    help="Mesh positions in each kind of contact.",
)
@_refine
@_near
@delivery.plain_json
def stiffness(
    case: str,
    overrides: tuple[str, ...],
    torque: float | None,
    positions: int,
    refine: int,
    near: str,
    as_json: bool,
) -> None:
    """Mesh stiffness and load shares of CASE's pair: model, finite elements, difference."""
    from thermogear.base.display import LINE_LOAD
    from thermogear.gears.tooth_mesh import Density
    from thermogear.verify.checks import check_stiffness, inner_phases

    read = delivery.load_gears(case, overrides)
    moment = max(read.torques) if torque is None else torque
    if not 0.0 < moment < float("inf"):
        raise InputError("torque", f"{moment:g} N m", allowed="> 0", fix="state --torque")
    pair = read.pair
    found = check_stiffness(
        pair,
        moment / pair.pinion.base_radius,
        inner_phases(pair, positions),
        Density(refinement=refine),
        near,
    )
    _say(
        as_json,
        read.title,
        f"{moment:g} N m on the pinion, F_n/b = {LINE_LOAD(found.line_load):.4g} N/mm",
        *_notes(near),
        "",
        *_stiffness_lines(found),
    )
    if as_json:
        content = {"title": read.title, "torque": moment, "near": near, "notes": STIFFNESS_NOTES}
        click.echo(json_text(content | _stiffness_numbers(found)), nl=False)


@verify.command()
@delivery.case
@delivery.overrides
@click.option(
    "--bore", default="free", show_default=True, help="Support of the bores: free, rigid, shaft."
)
@delivery.plain_json
def growth(case: str, overrides: tuple[str, ...], bore: str, as_json: bool) -> None:
    """Thermal growth of both gears' flanks in CASE: model, finite elements, difference."""
    import numpy as np

    from thermogear.base.display import CELSIUS
    from thermogear.heat.expansion import RadialField
    from thermogear.verify.checks import check_growth

    read = delivery.load_gears(case, overrides)
    heat = read.operating.temperatures
    gears = (
        ("pinion", read.pair.pinion, heat.pinion_bore, heat.pinion_addendum),
        ("wheel", read.pair.wheel, heat.wheel_bore, heat.wheel_addendum),
    )
    content: dict[str, Any] = {"title": read.title, "bore": bore}
    _say(as_json, read.title, f"normal growth of one flank, plane stress, bores {bore}")
    for name, gear, inner, outer in gears:
        at_bore, at_tip = (float(np.ravel(np.asarray(t))[0]) for t in (inner, outer))
        field = RadialField(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            bore_temperature=at_bore,
            addendum_temperature=at_tip,
            reference=heat.reference,
        )
        found = check_growth(gear, field, bore=bore)
        content[name] = {
            "unit": "m",
            "radius": found.radius.tolist(),
            "model": found.model.tolist(),
            "finite_elements": found.finite.tolist(),
            "difference": found.difference.tolist(),
        }
        _say(
            as_json,
            "",
            f"{name}: bore {CELSIUS(at_bore):.4g} degC, "
            f"addendum {CELSIUS(at_tip):.4g} degC, "
            f"drawn at {CELSIUS(heat.reference):.4g} degC",
            *_growth_lines(found),
        )
    if as_json:
        click.echo(json_text(content), nl=False)


@verify.command()
@_refine
@_near
@delivery.plain_json
def pairs(refine: int, near: str, as_json: bool) -> None:
    """The fixed pairs: published, own, at the model's edges, with corners, drawn, and roots."""
    from thermogear.base.display import LINE_LOAD, PERCENT
    from thermogear.gears.tooth_mesh import Density
    from thermogear.verify.checks import check_root, check_stiffness, inner_phases
    from thermogear.verify.pairs import (
        corner_pairs,
        drawn_pairs,
        far_pairs,
        own_pairs,
        published_pair,
        root_pairs,
    )

    groups: tuple[tuple[str, tuple[CheckedPair, ...]], ...] = (
        ("published", (published_pair(),)),
        ("own", own_pairs()),
        ("edges", far_pairs()),
        ("corners", corner_pairs()),
        ("drawn", drawn_pairs()),
    )
    content: dict[str, Any] = {"near": near, "notes": STIFFNESS_NOTES}
    _say(as_json, *_notes(near))
    for group, members in groups:
        worst: tuple[float, str] = (0.0, "")
        for checked in members:
            found = check_stiffness(
                checked.pair,
                checked.line_load * checked.pair.face_width,
                _CORNER_PHASES if checked.corners else inner_phases(checked.pair, 4),
                Density(refinement=refine),
                near,
                deviations=checked.deviations,
                corners=checked.corners,
            )
            content.setdefault(group, {})[checked.name] = _stiffness_numbers(found)
            of_swing = abs(float(found.error[found.worst])) / found.peak_to_peak[1]
            worst = max(worst, (of_swing, checked.name))
            load = f"{LINE_LOAD(checked.line_load):g} N/mm"
            _say(as_json, "", f"{checked.name}, {load} ({group})", *_stiffness_lines(found))
        told = f"{PERCENT(worst[0]):.2f} % of its peak-to-peak error"
        _say(as_json, "", f"worst of the {group} pairs: {worst[1]}, {told}")
    _say(
        as_json, "", "greatest stress of a root over F_n/(b m): model, finite elements, difference"
    )
    for checked, gear in root_pairs():
        model, finite = check_root(checked.pair, gear, Density(refinement=refine))
        row = {"gear": gear, "model": model, "finite_elements": finite}
        content.setdefault("root", {})[checked.name] = row
        off = PERCENT(model / finite - 1.0)
        _say(as_json, f"{checked.name}, {gear}: {model:.4f}, {finite:.4f}, {off:+.2f} %")
    if as_json:
        click.echo(json_text(content), nl=False)


def _say(as_json: bool, *lines: str) -> None:
    """Print ``lines`` at once, unless a script wants JSON."""
    if not as_json:
        click.echo("\n".join(lines))


def _notes(near: str) -> list[str]:
    return [f"- {note}" for note in (*STIFFNESS_NOTES, f"around the contacts plane {near}")]


def _stiffness_numbers(found: StiffnessCheck) -> dict[str, Any]:
    return {
        "unit": "N/m",
        "line_load_n_per_m": found.line_load,
        "phase": found.phase.tolist(),
        "model": found.model.tolist(),
        "finite_elements": found.finite.tolist(),
        "relative_difference": found.difference.tolist(),
        "model_share": found.model_share.tolist(),
        "finite_share": found.finite_share.tolist(),
        "deflection_error_m": found.error.tolist(),
        "worst_deflection_error_m": float(found.error[found.worst]),
        "worst_share_difference": found.worst_share,
        "peak_to_peak_m": dict(zip(("model", "finite_elements"), found.peak_to_peak, strict=True)),
    }


def _stiffness_lines(found: StiffnessCheck) -> list[str]:
    """The check as a table of the terminal, and where both are farthest apart."""
    from thermogear.base.display import MICROMETRE, PERCENT, STIFFNESS_PER_WIDTH
    from thermogear.results.tables import rows_of
    from thermogear.views.columns import Column, declared
    from thermogear.views.page import lines_of

    columns = (
        Column("phase", "phase", ".4f"),
        Column("pairs", "pairs"),
        Column("model", "model", ".3f"),
        Column("FE", "finite", ".3f"),
        Column("error [um]", "error", "+.4f", MICROMETRE),
        Column("share", "share", ".4f"),
        Column("FE", "finite_share", ".4f"),
        Column("difference", "share_difference", "+.4f"),
    )
    by_name = {
        "phase": found.phase,
        "pairs": found.pairs,
        "model": STIFFNESS_PER_WIDTH(found.model / found.face_width),
        "finite": STIFFNESS_PER_WIDTH(found.finite / found.face_width),
        "error": found.error,
        "share": found.model_share[:, 1],
        "finite_share": found.finite_share[:, 1],
        "share_difference": found.share_difference[:, 1],
    }
    worst = found.worst
    return [
        *lines_of(declared("secant, N/(mm um); deflection's error", columns, rows_of(by_name))),
        f"worst: deflection {MICROMETRE(found.error[worst]):+.4f} um at {found.phase[worst]:.4f}, "
        f"{PERCENT(found.error[worst] / found.peak_to_peak[1]):+.2f} % of the peak-to-peak error, "
        f"share {found.worst_share:.4f}",
        "transmission error, peak to peak: model {:.3f} um, finite elements {:.3f} um".format(
            *(MICROMETRE(size) for size in found.peak_to_peak)
        ),
    ]


def _growth_lines(found: GrowthCheck) -> list[str]:
    """The check as a table of the terminal, and where both are farthest apart."""
    from thermogear.base.display import MICROMETRE, MILLIMETRE
    from thermogear.results.tables import rows_of
    from thermogear.views.columns import Column, declared
    from thermogear.views.page import lines_of

    columns = (
        Column("radius", "radius", ".4f", MILLIMETRE),
        Column("model", "model", ".3f", MICROMETRE),
        Column("FE", "finite", ".3f", MICROMETRE),
        Column("model - FE", "difference", "+.3f", MICROMETRE),
    )
    by_name = {name: getattr(found, name) for name in ("radius", "model", "finite", "difference")}
    worst = found.worst
    return [
        *lines_of(declared("", columns, rows_of(by_name))),
        f"worst {MICROMETRE(found.difference[worst]):+.3f} um "
        f"at {MILLIMETRE(found.radius[worst]):.4f} mm",
    ]


COMMANDS: tuple[click.Command, ...] = (verify,)
