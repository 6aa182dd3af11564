"""``friction``, ``temperature``, ``warmup``, ``relief`` and ``contact``: surveys of a gear case."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.results.result import Result


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
    written above it. A DXF file holds the true outlines in mm on the layers cold and hot.

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
            allowed=" | ".join(f".{one}" for one in ENDINGS),
            fix="end its name with .svg",
        )
    if path.is_dir() or not path.parent.is_dir():
        why = "it is a directory" if path.is_dir() else f"there is no directory {path.parent}"
        raise InputError("output", output, why=why, fix="name a file")
    if enlarge is not None and not 1.0 <= enlarge <= 1000.0:
        raise InputError("--enlarge", f"{enlarge:g}", allowed="1..1000")
    read = delivery.load_gears(case, overrides)

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
    found = gear_drawing(result.data, factor=enlarge)
    if kind == "dxf":
        from thermogear.views.cad import put_dxf

        put_dxf(found, path, place=0, shown=SHOWN[show])
    else:
        from thermogear.views.plots.gears import in_mesh
        from thermogear.views.svg import put_picture

        name = {"both": "both", "cold": "undeformed", "hot": "hot"}[show]
        put_picture(in_mesh(found, phase, name), path, resolution=RESOLUTION)
    delivery.tell(page_of(result), path, as_json=as_json)


_Command = TypeVar("_Command", bound=Callable[..., Any])


def _common(command: _Command) -> _Command:
    """What every survey takes."""
    for option in (
        delivery.as_json,
        delivery.csv,
        delivery.overrides,
        delivery.output(),
        delivery.case,
    ):
        command = option(command)
    return command


@click.command()
@delivery.case
@delivery.output("Directory for results and a page of the answers.", required=False)
@delivery.overrides
@delivery.as_json
def answers(case: str, output: str | None, overrides: tuple[str, ...], as_json: bool) -> None:
    """Answer what one wants to know of CASE: each in a sentence with its limit and a verdict.

    Does it mesh, how hot does it run, what is left of the backlash, is there a film, at which
    speeds does it resonate or lose contact, how large are dynamic factor and transmission error.
    """
    read = delivery.load_gears(case, overrides)

    def make(report: Progress) -> Result:
        from thermogear.study.answers.survey import answers as study

        return study(read, progress=report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@_common
def friction(case: str, output: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Draw every friction law over CASE's path of contact, with ranges and regime.

    Writes friction.nc, friction.html, pictures and CSV to DIR.
    """
    read = delivery.load_gears(case, overrides)

    def make(report: Progress) -> Result:
        from thermogear.study.friction import friction_survey

        return friction_survey(read)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@_common
@click.option(
    "--speeds",
    metavar="RPM[,RPM...]",
    help="Pinion speeds, or FROM:TO:COUNT; 500:6000:12 if left out.",
)
@click.option(
    "--torques",
    metavar="NM[,NM...]",
    help="Pinion torques, or FROM:TO:COUNT; 50:500:10 if left out.",
)
@click.option("--own", is_flag=True, help="Take the speeds and torques of the case instead.")
@click.option("--force", is_flag=True, help="Run even if it may not fit into the free memory.")
def temperature(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    speeds: str | None,
    torques: str | None,
    own: bool,
    force: bool,
) -> None:
    """Close the loop of friction and heat over speeds and torques: the map of everything hot.

    Regime, flash and body temperature, backlash left, scuffing margin, ISO estimates; for the
    thesis's rig its first conclusion, checked. Steady states alone: `warmup` follows the way there.
    Temperatures that CASE gives are not used; nodes that [gearbox.measured] holds are. Writes
    temperature.nc, temperature.html, pictures and CSV.
    """
    read = delivery.load_gears(case, overrides)
    if own and (speeds or torques):
        raise InputError("--own", "speeds or torques beside it", fix="leave one out")

    from thermogear.case.size import require_points
    from thermogear.study.temperature import SPEEDS, TORQUES, thermal_map

    omega = _axis("--speeds", speeds, RPM, SPEEDS) if not own else read.speeds
    moment = _axis("--torques", torques, 1.0, TORQUES) if not own else read.torques
    require_points(len(omega) * len(moment), forced=force)

    def make(report: Progress) -> Result:
        return thermal_map(read, omega, moment, progress=report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@_common
@click.option(
    "--duty",
    metavar="FILE",
    help="CSV table of the duty: time [min],speed [rpm],torque [N m],ambient [degC]; each row "
    "holds until the next, the last says the end.",
)
@click.option(
    "--at",
    metavar="RPM,NM",
    help="Operating point that is held until steady, without a table; the case's of the greatest "
    "power if left out.",
)
@click.option(
    "--start",
    type=float,
    metavar="DEGC",
    help="Temperature of everything at the start; the ambient's if left out.",
)
@click.option(
    "--measured",
    metavar="FILE",
    help="CSV record to draw over the curves: time [min],pinion_tooth [degC],oil [degC],...; "
    "columns named by nodes or sensors.",
)
@click.option(
    "--fit",
    metavar="NAME[,NAME]",
    help="Fit one or two heat-transfer factors to the record: housing, oil_housing, wetted, "
    "shafts.",
)
def warmup(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    duty: str | None,
    at: str | None,
    start: float | None,
    measured: str | None,
    fit: str | None,
) -> None:
    """Follow CASE through its duty from a cold start: when is the backlash least?

    Temperatures of gears, shafts, housing and oil, half backlash and margin to the jam, flash, film
    and stiffness over time; what a thermocouple, a ring on the shaft and an infrared camera
    ([sensors]) would show. Temperatures that CASE gives are not used; nodes that
    [gearbox.measured] holds are. Writes warmup.nc, warmup.html, pictures and CSV to DIR.
    """
    from thermogear.case.allowed import kelvin

    read = delivery.load_gears(case, overrides)
    begin = None if start is None else kelvin("--start", start)
    if duty is not None and at is not None:
        raise InputError("--at", "an operating point beside --duty", fix="leave one out")

    from thermogear.case.duty import point_duty, read_duty, read_measured
    from thermogear.mesh.warm_up_fit import require_factors
    from thermogear.study.warm_up import warm_up_survey

    work = None if duty is None else read_duty(duty, read)
    if at is not None:
        point = _numbers("--at", at)
        if len(point) != 2:
            raise InputError("--at", repr(at), allowed="RPM,NM", fix="write 2000,150")
        work = point_duty(read, point[0] * RPM, point[1], "--at")
    record = None if measured is None else read_measured(measured)
    names: tuple[str, ...] = ()
    if fit is not None:
        names = require_factors([name.strip() for name in fit.split(",")], "--fit")
        if record is None:
            raise InputError("--fit", fit, why="there is no record", fix="give --measured FILE too")

    def make(report: Progress) -> Result:
        return warm_up_survey(read, work, start=begin, measured=record, fit=names, progress=report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@_common
@click.option(
    "--torque", type=float, metavar="NM", help="Pinion torque; the case's greatest if left out."
)
@click.option(
    "--temperature",
    "celsius",
    type=float,
    metavar="DEGC",
    help="Addendum temperature of both gears, the rest as temperatures.follow says; the case's hot "
    "state if left out.",
)
@click.option(
    "--shape",
    type=click.Choice(["linear", "parabolic"]),
    default="linear",
    show_default=True,
    help="Form of the relief.",
)
@click.option("--symmetric", is_flag=True, help="The same amount and length on both gears.")
@click.option("--largest", type=float, metavar="UM", help="Greatest amount to be tried.")
def relief(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    torque: float | None,
    celsius: float | None,
    shape: str,
    symmetric: bool,
    largest: float | None,
) -> None:
    """Find the tip relief that makes CASE's hot pair run most evenly under load.

    Least peak-to-peak static transmission error, drawn against the unrelieved pair; prints the
    lines for the case file. Writes relief.nc, relief.html, pictures and CSV to DIR.
    """
    from thermogear.case.allowed import kelvin

    read = delivery.load_gears(case, overrides)
    for name, value in (("--torque", torque), ("--largest", largest)):
        if value is not None:
            _positive(name, [value])
    held = None if celsius is None else kelvin("--temperature", celsius)

    def make(report: Progress) -> Result:
        from thermogear.study.relief import relief_survey

        return relief_survey(
            read,
            torque=torque,
            gear_temperature=held,
            shape=shape,
            symmetric=symmetric,
            largest=None if largest is None else 1e-6 * largest,
            progress=report,
        )

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@_common
@click.option(
    "--torques",
    metavar="NM[,NM...]",
    help="Pinion torques, or FROM:TO:COUNT; parts of the case's greatest if left out.",
)
@click.option(
    "--body",
    type=click.Choice(["bore-clamped", "rim"]),
    help="Reading of the hub: held at the bore (statics), or without its wind-up [the case's].",
)
def contact(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    torques: str | None,
    body: str | None,
) -> None:
    """Loaded tooth contact of CASE over mesh position, load and temperature.

    Tangent and secant stiffness, transmission error, load shares, pressure, double contact (and
    how gears of unequal temperature lose it at light load), how long tip corners carry (edge
    contact, where no pressure is given), and ISO 6336-1. Writes contact.nc, contact.html,
    pictures and CSV to DIR.
    """
    read = delivery.load_gears(case, overrides)
    moments = _axis("--torques", torques, 1.0, ())

    def make(report: Progress) -> Result:
        from thermogear.study.contact import loaded_survey

        return loaded_survey(read, moments, body=body, progress=report)

    delivery.deliver(make, output, as_json=as_json)


COMMANDS: tuple[click.Command, ...] = (
    draw,
    answers,
    friction,
    temperature,
    warmup,
    relief,
    contact,
)
"""For the main group to register."""


# --- from words to values ---------------------------------------------------------------------


def _axis(
    option: str, text: str | None, scale: float, otherwise: tuple[float, ...]
) -> tuple[float, ...]:
    """SI values of an axis: numbers with commas, or FROM:TO:COUNT."""
    if text is None:
        return otherwise
    if ":" in text:
        parts = text.split(":")
        low, high, number = (_numbers(option, ",".join(parts)) + [math.nan] * 3)[:3]
        if len(parts) != 3 or not (number == int(number or 0) and 2 <= number <= 100_000):
            raise InputError(
                option,
                repr(text),
                allowed="FROM:TO:COUNT, COUNT 2..100000",
                fix="write 500:6000:12",
            )
        count = int(number)
        values = [low + (high - low) * k / (count - 1) for k in range(count)]
    else:
        values = _numbers(option, text)
    _positive(option, values)
    if any(b <= a for a, b in pairwise(values)):
        raise InputError(option, repr(text), allowed="strictly rising values")
    return tuple(scale * value for value in values)


def _numbers(option: str, text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as cause:
        raise InputError(
            option, repr(text), allowed="numbers with commas between", fix="write 500,1000,2000"
        ) from cause


def _positive(option: str, values: list[float]) -> None:
    for value in values:
        if not 0.0 < value < math.inf:
            raise InputError(option, f"{value:g}", allowed="> 0, finite")
        if value >= 1e9:
            raise InputError(option, f"{value:g}", allowed="> 0, below 1e9")
