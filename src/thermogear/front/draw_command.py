"""``draw``: the gears of a case in mesh, as a picture or a drawing file."""

from __future__ import annotations

from pathlib import Path

import click

from thermogear.base.errors import InputError
from thermogear.front import delivery

PICTURES = ("svg", "png", "pdf")
ENDINGS = (*PICTURES, "dxf")
FINE = 5
"""How many times finer the outlines of a DXF file are than those of a picture."""
SHOWN = {"both": ("undeformed", "hot"), "cold": ("undeformed",), "hot": ("hot",)}


@click.command()
@delivery.case
@click.option(
    "-o",
    "--output",
    default="gears.svg",
    metavar="FILE",
    show_default=True,
    help="The file; its ending says what: svg, png, pdf, or dxf (extra [cad]).",
)
@click.option("--operating", type=int, help="Operating point, from 1 (speeds x torques) [1].")
@click.option("--bundle", metavar="NAME", help="Bundle of the case [the first].")
@click.option("--state", help="hot | computed | the gears' temperature in degC [hot].")
@click.option(
    "--phase",
    type=float,
    default=0.25,
    show_default=True,
    help="Part of the mesh period, 0..1; at 0 a pair enters.",
)
@click.option(
    "--enlarge",
    type=float,
    metavar="FACTOR",
    help="How many times larger gaps, growth and deviations are drawn [what fits].",
)
@click.option(
    "--show",
    type=click.Choice(list(SHOWN)),
    default="both",
    show_default=True,
    help="Outlines as drawn, hot, or both over each other.",
)
@delivery.overrides
@delivery.as_json
def draw(
    case: str,
    output: str,
    operating: int | None,
    bundle: str | None,
    state: str | None,
    phase: float,
    enlarge: float | None,
    show: str,
    overrides: tuple[str, ...],
    as_json: bool,
) -> None:
    """Draw CASE's gears in mesh: true flanks, cold and hot, the contact points and their load.

    Both gears to scale, and the mesh with gaps, growth and deviations enlarged by the factor
    written above it. A DXF file holds the true outlines in mm on the layers cold and hot. Flanks
    are nominal, with reliefs alone; --part case draws what else CASE gives.

    \b
      thermogear draw rig.toml -o gears.svg
      thermogear draw rig.toml --phase 0.5 --enlarge 20 -o gears.png
    """
    path = Path(output)
    kind = path.suffix.removeprefix(".").lower()
    if kind not in ENDINGS:
        raise InputError(
            "output",
            repr(output),
            allowed=" | ".join(f".{ending}" for ending in ENDINGS),
            fix="end its name with .svg",
        )
    if path.is_dir() or not path.parent.is_dir():
        why = "it is a directory" if path.is_dir() else f"there is no directory {path.parent}"
        raise InputError("output", output, why=why, fix="name a file")
    if enlarge is not None and not 1.0 <= enlarge <= 1000.0:
        raise InputError("--enlarge", f"{enlarge:g}", allowed="1..1000")
    if delivery.OF_PART["--turn"] in overrides:
        raise InputError("--turn", "a drawing", why="its teeth are all alike", fix="leave it out")
    read = delivery.load_gears(case, overrides).unless_stated("part", "nominal")

    from thermogear.case.thermal_state import ThermalState
    from thermogear.study.drawing import drawing
    from thermogear.views.gears import gear_drawing
    from thermogear.views.write import RESOLUTION, page_of

    heat = ThermalState.parse("hot" if state is None else state, "--state")
    result = drawing(
        read,
        operating=operating,
        bundle=bundle,
        state=heat,
        phase=phase,
        fineness=FINE if kind == "dxf" else 1,
    )
    drawn = gear_drawing(result.data, factor=enlarge)
    if kind == "dxf":
        from thermogear.views.cad import put_dxf

        put_dxf(drawn, path, place=0, shown=SHOWN[show])
    else:
        from thermogear.views.plots.gears import in_mesh
        from thermogear.views.svg import put_picture

        name = {"both": "both", "cold": "undeformed", "hot": "hot"}[show]
        put_picture(in_mesh(drawn, phase, name), path, resolution=RESOLUTION)
    delivery.tell(page_of(result), path, as_json=as_json)


COMMANDS: tuple[click.Command, ...] = (draw,)
"""For the main group to register."""
