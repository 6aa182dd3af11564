"""``thermogear measure`` and ``thermogear compare``: commands for the main group to register."""

from __future__ import annotations

import json
import math
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.units import RPM

if TYPE_CHECKING:
    import xarray as xr

    from thermogear.measured.reduction import Measurement
    from thermogear.study.compare import Comparison


def _supplies(command: Any) -> Any:
    """The options that supply what a file does not state."""
    for option in (
        click.option("--rate", type=float, metavar="HZ", help="Samples per second."),
        click.option(
            "--unit", metavar="UNIT", help="Unit of the vibration channels: g, m/s^2, ..."
        ),
        click.option("--scale", type=float, help="Units at full scale, for integer samples."),
        click.option("--teeth", type=int, help="Teeth of the pinion."),
        click.option("--speed", type=float, metavar="RPM", help="Nominal speed of the pinion."),
        click.option(
            "--channel", "channels", multiple=True, help="Channel to use (name or number)."
        ),
        click.option("--tacho", help="Tacho channel (name or number)."),
        click.option("--pulses", type=float, help="Tacho pulses per turn."),
        click.option(
            "--decimal", type=click.Choice([".", ","]), help="Decimal sign of a text file."
        ),
        click.option(
            "--limit",
            type=float,
            metavar="GIB",
            help="Most GiB that a packed file may become [32 times its size, 0.25..8].",
        ),
        click.option(
            "--sensor-tolerance", type=float, help="Relative standard uncertainty of the sensor."
        ),
        click.option(
            "--method",
            default="frequency",
            show_default=True,
            help="Acceleration to displacement: frequency, line, or trapezoid as in the thesis.",
        ),
    ):
        command = option(command)
    return command


def _require_gear(options: dict[str, Any]) -> None:
    """Refuse teeth and a speed that no gear has, before anything is read."""
    from thermogear.measured.reduction import require_teeth

    speed = options["speed"]
    from thermogear.base.bounds import SPEED

    if speed is not None and not 0.0 < speed * RPM <= SPEED.most:
        raise InputError("--speed", f"{speed:g} rpm", allowed=f"> 0 .. {SPEED.high:g} rpm")
    require_teeth(options["teeth"])


def _measured(file: str, options: dict[str, Any]) -> Measurement:
    from thermogear.measured.chain import Chain
    from thermogear.measured.options import bytes_of_gibibytes
    from thermogear.measured.readers import read_record
    from thermogear.measured.reduction import measure as reduce

    speed, limit = options["speed"], options["limit"]
    record = read_record(
        file,
        rate=options["rate"],
        unit=options["unit"],
        scale=options["scale"],
        channels=options["channels"],
        tacho=options["tacho"],
        decimal=options["decimal"],
        limit=None if limit is None else bytes_of_gibibytes(limit),
    )
    return reduce(
        record,
        teeth=options["teeth"],
        speed=None if speed is None else speed * RPM,
        chain=Chain(options["method"]),
        sensor_tolerance=options["sensor_tolerance"],
        pulses_per_turn=options["pulses"],
    )


@click.command()
@click.argument("file", metavar="FILE")
@_supplies
@click.option("--json", "as_json", is_flag=True, help="Print the lines as JSON.")
@click.option("-o", "--output", metavar="DIR", help="Also write measured.nc and measured.html.")
def measure(file: str, as_json: bool, output: str | None, **options: Any) -> None:
    """Read a record and print its lines: order, frequency, amplitude, uncertainty."""
    _require_gear(options)
    with _claimed(output) as folder:
        found = _measured(file, options)
        if folder is not None:
            from thermogear import __version__
            from thermogear.measured.dataset import tree_of

            _store(tree_of(found, __version__), folder, "measured")
    _name_page(output, "measured", as_json)
    if as_json:
        click.echo(json.dumps(_as_dict(found), indent=2, ensure_ascii=False))
        return
    for notice in found.notices:
        click.echo(f"{notice.level}: {notice.text}")
    if found.gearing is not None:
        for text in found.gearing.evidence:
            click.echo(f"evidence: {text}")
    for name, value in found.settings.items():
        click.echo(f"{name}: {value}")
    head = f"{'channel':12} {'line':22} {'order':>9} {'cyc/sample':>11} {'Hz':>10} {'reading':>10}"
    click.echo(f"{head} {'g':>9} {'um':>9} {'u_D %':>7}")
    for line in found.lines:
        click.echo(
            f"{line.channel[:12]:12} {line.name[:22]:22} {_text(line.order, 9, 3)} "
            f"{_text(line.position, 11, 6)} {_text(line.frequency, 10, 3)} "
            f"{_text(line.reading, 10, 4)} {_text(line.acceleration_g, 9, 3)} "
            f"{_text(line.displacement * 1e6, 9, 3)} {_text(100 * line.uncertainty, 7, 2)}"
        )


@click.command()
@click.argument("case", metavar="CASE")
@click.argument("measured", metavar="[FILE|TABLE]", required=False)
@_supplies
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="FIELD=PERCENT",
    help="Standard uncertainty of a field of the case, as operating.torque=5. May be repeated.",
)
@click.option("--samples", type=int, default=12, help="Runs for the input uncertainty.")
@click.option("--u-data", type=float, metavar="PERCENT", help="Uncertainty of the measurement.")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON.")
@click.option("-o", "--output", metavar="DIR", help="Also write comparison.nc and comparison.html.")
def compare(
    case: str,
    measured: str | None,
    tolerances: tuple[str, ...],
    samples: int,
    u_data: float | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> None:
    """Compare CASE (a case, a directory of results, or thesis-5.2) with a record or a table."""
    from thermogear.measured.published import PUBLISHED
    from thermogear.study import compare as comparison

    _require_gear(options)
    speed = options["speed"]
    against: Any = measured
    with _claimed(output) as folder:
        if measured is not None and measured not in PUBLISHED and not comparison.is_table(measured):
            against = _measured(measured, options)
        found = comparison.compare(
            case,
            against,
            teeth=options["teeth"],
            speed=None if speed is None else speed * RPM,
            u_data=None if u_data is None else u_data / 100.0,
            tolerances=dict(_tolerance(text) for text in tolerances),
            samples=samples,
        )
        if folder is not None:
            from thermogear import __version__

            _store(comparison.tree_of(found, __version__), folder, "comparison")
    _name_page(output, "comparison", as_json)
    if as_json:
        click.echo(comparison.as_json(found))
    else:
        _print(found)


def _tolerance(text: str) -> tuple[str, float]:
    name, sign, value = text.partition("=")
    try:
        number = float(value.strip().removesuffix("%"))
    except ValueError:
        number = float("nan")
    if not (sign and name.strip() and number >= 0):
        raise InputError("--tolerance", repr(text), allowed="FIELD=PERCENT, as operating.torque=5")
    return name.strip(), number / 100.0


def _print(found: Comparison) -> None:
    for level, text in found.notices:
        click.echo(f"{level}: {text}")
    for row in found.rows:
        factor, unit = (1e6, "um") if row.quantity == "displacement" else (1.0, "Hz")
        models = ", ".join(
            f"{name} {value * factor:.5g} {unit} ({100 * error:+.2f} %)"
            for name, value, error in zip(found.models, row.simulated, row.errors, strict=True)
        )
        click.echo(
            f"{row.speed / RPM:.0f} rpm, {row.quantity}: measured {row.measured * factor:.5g} "
            f"{unit}; {models}; u_val {100 * row.u_val:.2f} % (num {100 * row.u_num:.2f}, input "
            f"{100 * row.u_input:.2f}, data {100 * row.u_data:.2f}); {row.verdict}"
        )
    for item in found.implied:
        text = f"{item.speed / RPM:.0f} rpm: the line implies {item.acceleration_g:.1f} g"
        if item.shaft_speed is not None:
            text += f" and {item.shaft_speed / RPM:.1f} rpm"
        if item.offset_bins is not None:
            text += f", {item.offset_bins:+.2f} bins off the nominal mesh line"
        click.echo(text)
    click.echo(found.conclusion)


def _claimed(output: str | None) -> AbstractContextManager[Path | None]:
    """The folder that ``output`` gets its files from at the end; None where none is named."""
    from thermogear.results.files import claimed

    return nullcontext() if output is None else claimed(Path(output))


def _store(tree: xr.DataTree, folder: Path, name: str) -> None:
    """Store the tree and draw its page."""
    from thermogear.results.files import write_results
    from thermogear.views.measured_report import write_measured_report

    write_measured_report(write_results(tree, folder, f"{name}.nc"), folder / f"{name}.html")


def _name_page(output: str | None, name: str, quiet: bool) -> None:
    """Say where the page is, on the error stream if ``quiet``."""
    if output is not None:
        click.echo(str(Path(output) / f"{name}.html"), err=quiet)


def _text(value: float, width: int, digits: int) -> str:
    return f"{value:{width}.{digits}f}" if math.isfinite(value) else "-".rjust(width)


def _as_dict(found: Measurement) -> dict[str, Any]:
    def plain(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    gearing = found.gearing
    return {
        "source": found.record.source,
        "rate": found.record.rate,
        "settings": found.settings,
        "teeth": found.teeth,
        "mesh_position": gearing.mesh_frequency if gearing else None,
        "shafts": [shaft.__dict__ for shaft in gearing.shafts] if gearing else [],
        "meshes": [mesh.__dict__ for mesh in gearing.meshes] if gearing else [],
        "evidence": list(gearing.evidence) if gearing else [],
        "lines": [{k: plain(v) for k, v in line.__dict__.items()} for line in found.lines],
        "notices": [notice.__dict__ for notice in found.notices],
    }


COMMANDS: tuple[click.Command, ...] = (measure, compare)
