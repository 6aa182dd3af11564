"""``thermogear verify``: models against finite elements; a group for the main one to register."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.front import delivery
from thermogear.results.files import json_text

if TYPE_CHECKING:
    from thermogear.verify.checks import StiffnessCheck

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


COMMANDS: tuple[click.Command, ...] = (verify,)
