"""``import``: gearbox models of REXS as cases."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from thermogear.base.errors import printable
from thermogear.front import delivery
from thermogear.front.lines import say, show_path
from thermogear.results.files import json_text

if TYPE_CHECKING:
    from thermogear.case.rexs.model import Model


@click.command("import")
@click.argument("file", metavar="FILE")
@click.option("--stage", type=int, metavar="N", help="Make a case of stage N of the list.")
@click.option("-o", "--output", metavar="FILE", help="Write the case to a new FILE.")
@click.option("--speed", metavar="SPEED", help='Speed of the pinion, "3000 rpm", if FILE has none.')
@click.option("--torque", metavar="TORQUE", help='Its torque, "80 N m", if FILE has none.')
@delivery.plain_json
def import_(
    file: str,
    stage: int | None,
    output: str | None,
    speed: str | None,
    torque: str | None,
    as_json: bool,
) -> None:
    """List the shafts and stages of a REXS model, or write one stage as a case.

    XML (.rexs), JSON (.rexsj) and zip (.rexsz) of REXS 1.0 to 1.7 and 2.0.0. Each line of the case
    says whether it was read, derived or a default; what FILE holds and a case cannot is listed.

    \b
      thermogear import gearbox.rexs
      thermogear import gearbox.rexs --stage 2 -o mine.toml
    """
    from thermogear.base.files import put_new, require_new_file
    from thermogear.case.rexs.container import read_rexs
    from thermogear.case.rexs.importing import imported

    if output is not None:
        require_new_file(Path(output))
    model = read_rexs(file)
    if stage is None and output is None and speed is None and torque is None:
        _list(model, file, as_json=as_json)
        return
    found = imported(model, stage, speed=speed, torque=torque)
    for note in found.notes:
        say("warning", note)
    if as_json:
        content = {"case": found.text, "not used": found.unused, "notes": found.notes}
        click.echo(json_text(content), nl=False)
    if output is None:
        if not as_json:
            click.echo(found.text, nl=False)
        return
    place = Path(output)
    duty = place.with_name(f"{place.stem}-duty.csv")
    if found.duty:
        require_new_file(duty)
    written = [put_new(place, found.text)]
    if found.duty:
        written.append(put_new(duty, found.duty))
    if as_json:
        return
    for path in written:
        show_path(path)
    for line in found.unused:
        click.echo(f"  not used: {printable(line)}")
    show_path(output, "next: thermogear answers ")


def _list(model: Model, file: str, *, as_json: bool) -> None:
    """Shafts, stages and what is left out."""
    from thermogear.case.rexs.importing import left_out, listed, shafts

    found, notes = listed(model)
    turning = shafts(model)
    rest = [
        one
        for one in left_out(model)
        if one.partition(":")[0] not in ("shaft", "cylindrical_stage")
    ]
    if as_json:
        content = {
            "version": model.version,
            "application": model.application,
            "container": model.container,
            "load_cases": len(model.load_cases),
            "shafts": turning,
            "stages": [
                {
                    "stage": one.stage.number,
                    "id": one.stage.component.id,
                    "name": one.stage.component.name,
                    "pair": one.words,
                    "refused": None if one.why is None else str(one.why),
                }
                for one in found
            ],
            "parts": rest,
            "notes": notes,
        }
        click.echo(json_text(content), nl=False)
        return
    click.echo(
        f"REXS {model.version}, {model.container}, "
        f"{printable(model.application or 'an unnamed program')}; "
        f"{len(model.load_cases)} load cases"
    )
    click.echo("\nshafts")
    for line in turning or ["none"]:
        click.echo(f"  {printable(line)}")
    click.echo("\ncylindrical stages")
    for one in found:
        head = f"  {one.stage.number}  {one.stage.component.called}: "
        click.echo(printable(head + (one.words if one.why is None else f"no case; {one.why}")))
    if not found:
        click.echo("  none")
    if rest:
        click.echo("\nbeside them")
        for line in rest:
            click.echo(f"  {printable(line)}")
    for note in notes:
        say("warning", note)
    able = [one.stage.number for one in found if one.why is None]
    if able:
        click.echo(f"\nnext: thermogear import {printable(file)} --stage {able[0]} -o mine.toml")


COMMANDS: tuple[click.Command, ...] = (import_,)
"""For the main group to register."""
