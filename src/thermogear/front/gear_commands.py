"""``friction``, ``temperature``, ``warmup``, ``relief`` and ``contact``: surveys of a gear case."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM, ZERO_CELSIUS

if TYPE_CHECKING:
    import xarray as xr

    from thermogear.case.case import GearCase

_Command = TypeVar("_Command", bound=Callable[..., Any])


def _common(command: _Command) -> _Command:
    """What every survey takes."""
    for option in (
        click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON."),
        click.option(
            "--set",
            "overrides",
            multiple=True,
            metavar="PATH=VALUE",
            help="Put a value in place of the file's, as gears.pinion.teeth=30. May be repeated.",
        ),
        click.option(
            "-o",
            "--output",
            required=True,
            metavar="DIR",
            help="Directory of the results; made if new.",
        ),
        click.argument("case", metavar="CASE"),
    ):
        command = option(command)
    return command


@click.command()
@_common
def friction(case: str, output: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Draw every friction law over CASE's path of contact, with ranges and regime.

    Writes friction.nc, friction.html, pictures and CSV to DIR.
    """
    read = _gear_case(case, overrides)

    def make(report: Progress) -> xr.DataTree:
        from thermogear.study.friction import friction_survey

        return friction_survey(read)

    tree = _carry_out("friction", Path(output), make, quiet=as_json)
    data = tree["laws"].to_dataset()
    rows: list[dict[str, Any]] = []
    for law in data["law"].values:
        mean = data["mean_friction"].sel(law=law).values
        rows.append({"law": str(law), "mean_friction": [_finite(v) for v in mean]})
    found: dict[str, Any] = {
        "operating": _operating(data),
        "laws": rows,
        "regime_share": [
            dict(zip(map(str, data["regime_name"].values), map(float, shares), strict=True))
            for shares in data["regime_share"].values
        ],
    }
    lines = [f"{'law':<18}" + "".join(f"{name:>22}" for name in _names(data))]
    for row in rows:
        cells = "".join(f"{_text(v):>22}" for v in row["mean_friction"])
        lines.append(f"{row['law']:<18}{cells}")
    for name, shares in zip(_names(data), found["regime_share"], strict=True):
        words = ", ".join(f"{100.0 * v:.0f} % {k}" for k, v in shares.items())
        lines.append(f"{name}: {words}")
    _finish(tree, found, lines, Path(output) / "friction.html", as_json)


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
    read = _gear_case(case, overrides)
    if own and (speeds or torques):
        raise InputError("--own", "speeds or torques beside it", fix="leave one out")

    from thermogear.case.size import require_points
    from thermogear.study.temperature import SPEEDS, TORQUES, thermal_map

    omega = _axis("--speeds", speeds, RPM, SPEEDS) if not own else read.speeds
    moment = _axis("--torques", torques, 1.0, TORQUES) if not own else read.torques
    require_points(len(omega) * len(moment), forced=force)

    def make(report: Progress) -> xr.DataTree:
        return thermal_map(read, omega, moment, progress=report)

    tree = _carry_out("temperature", Path(output), make, quiet=as_json)
    data = tree["map"].to_dataset()
    names = (
        "greatest_flash",
        "least_half_backlash",
        "scuffing_margin",
        "least_film_parameter",
        "mean_friction",
        "residual",
    )
    found: dict[str, Any] = {
        "seconds": float(tree.attrs["seconds"]),
        "points": int(data["status"].size),
        "pinion_speed_rpm": [float(v) / RPM for v in data["pinion_speed"].values],
        "pinion_torque_Nm": [float(v) for v in data["pinion_torque"].values],
        "status": data["status"].values.tolist(),
        "iterations": data["iterations"].values.tolist(),
        "pinion_tooth_K": _table(data["node_temperature"].sel(node="pinion_tooth")),
        "oil_K": _table(data["node_temperature"].sel(node="oil")),
        **{name: _table(data[name]) for name in names},
        "conclusion": json.loads(tree.attrs["verdicts"]),
    }
    teeth = data["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"]).values
    figures = {
        "teeth [degC]": teeth - ZERO_CELSIUS,
        "greatest flash temperature [K]": data["greatest_flash"].values,
        "least half backlash [um]": 1e6 * data["least_half_backlash"].values,
        "scuffing margin [K]": data["scuffing_margin"].values,
        "least film parameter": data["least_film_parameter"].values,
        "mean friction coefficient": data["mean_friction"].values,
    }
    lines = [f"{words:<32} {_reach(values)}" for words, values in figures.items()]
    lines += [f"{one['claim']}: {one['verdict']} ({one['found']})" for one in found["conclusion"]]
    _finish(tree, found, lines, Path(output) / "temperature.html", as_json)


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

    read = _gear_case(case, overrides)
    begin = None if start is None else kelvin("--start", start)
    if duty is not None and at is not None:
        raise InputError("--at", "an operating point beside --duty", fix="leave one out")

    from thermogear.case.duty import point_duty, read_duty
    from thermogear.study.warm_up import read_measured, warm_up_survey
    from thermogear.study.warm_up_fit import require_factors

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

    def make(report: Progress) -> xr.DataTree:
        return warm_up_survey(read, work, start=begin, measured=record, fit=names, progress=report)

    tree = _carry_out("warmup", Path(output), make, quiet=as_json)
    texts, data = tree.attrs, tree["course"].to_dataset()
    worst = json.loads(texts["worst"])
    error = data["sensor_temperature"].values[-1] - data["true_temperature"].values[-1]
    found: dict[str, Any] = {
        "worst": worst,
        "jams_s": json.loads(texts["jams"]),
        "end_K": {
            str(node): float(t)
            for node, t in zip(
                data["node"].values, data["node_temperature"].values[-1], strict=True
            )
        },
        "sensor_error_at_the_end_K": {
            str(name): float(e) for name, e in zip(data["sensor"].values, error, strict=True)
        },
        "greatest_imbalance": float(texts["greatest_imbalance"]),
        "evaluations": int(texts["evaluations"]),
        "seconds": float(texts["seconds"]),
        "fit": json.loads(texts["fit"]),
    }
    from thermogear.views.warm_up_section import answer, fit_sentence

    lines = [answer(worst, float(texts["cold_half_backlash"])).replace("−", "-")]
    if found["fit"]:
        lines.append(fit_sentence(found["fit"]).strip())
    degrees = [(name, f"{t - ZERO_CELSIUS:.1f}") for name, t in found["end_K"].items()]
    lines.append("at the end [degC]: " + ", ".join(f"{name} {t}" for name, t in degrees))
    shown = [f"{n} {e:+.2f}" for n, e in found["sensor_error_at_the_end_K"].items()]
    lines.append("sensors, shown less true at the end [K]: " + ", ".join(shown))
    _finish(tree, found, lines, Path(output) / "warmup.html", as_json)


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

    read = _gear_case(case, overrides)
    for name, value in (("--torque", torque), ("--largest", largest)):
        if value is not None:
            _positive(name, [value])
    held = None if celsius is None else kelvin("--temperature", celsius)

    def make(report: Progress) -> xr.DataTree:
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

    tree = _carry_out("relief", Path(output), make, quiet=as_json)
    attributes, error = tree.attrs, tree["error"].to_dataset()
    found: dict[str, Any] = {
        "torque_Nm": float(attributes["torque"]),
        "unrelieved_m": float(attributes["unrelieved"]),
        "relieved_m": float(attributes["relieved"]),
        "evaluations": int(attributes["evaluations"]),
        "reliefs": json.loads(attributes["reliefs"]),
        "edge_contact_share": {
            str(one["pair_kind"].values): float(one) for one in error["edge_contact_share"]
        },
        "paste": attributes["paste"],
    }
    before, after = 1e6 * found["unrelieved_m"], 1e6 * found["relieved_m"]
    lines = [
        f"transmission error at {found['torque_Nm']:g} N m: {before:.3f} um peak to peak without, "
        f"{after:.3f} um with relief",
        "",
        "# for the case file, in place of tip reliefs it has already",
        *found["paste"].splitlines(),
        "",
    ]
    _finish(tree, found, lines, Path(output) / "relief.html", as_json)


@click.command()
@_common
@click.option(
    "--torques",
    metavar="NM[,NM...]",
    help="Pinion torques, or FROM:TO:COUNT; parts of the case's greatest if left out.",
)
@click.option(
    "--body",
    type=click.Choice(["bore_clamped", "rim"]),
    default="bore_clamped",
    show_default=True,
    help="Reading of the hub: held at the bore (statics), or without its wind-up.",
)
def contact(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    torques: str | None,
    body: str,
) -> None:
    """Loaded tooth contact of CASE over mesh position, load and temperature.

    Tangent and secant stiffness, transmission error, load shares, pressure, double contact (and
    how gears of unequal temperature lose it at light load), how long tip corners carry (edge
    contact, where no pressure is given), beside ISO 6336-1. Writes contact.nc, contact.html,
    pictures and CSV to DIR.
    """
    read = _gear_case(case, overrides)
    moments = _axis("--torques", torques, 1.0, ())

    def make(report: Progress) -> xr.DataTree:
        from thermogear.study.contact import loaded_survey

        return loaded_survey(read, moments, body=body, progress=report)

    tree = _carry_out("contact", Path(output), make, quiet=as_json)
    data, iso = tree["contact"].to_dataset(), tree["iso_6336"].to_dataset()
    found: dict[str, Any] = {
        "pinion_torque_Nm": [float(v) for v in data["load"].values],
        "temperature": [str(v) for v in data["temperature"].values],
        "mean_stiffness": _table(data["mean_stiffness"]),
        "double_contact_length_m": _table(data["double_contact_length"]),
        "edge_contact_share": _table(data["edge_contact_share"]),
        "iso_6336_stiffness": [float(v) for v in iso["iso_stiffness"].values],
    }
    head = f"{'N m':>10} {'k undeformed':>14} {'k hot':>12} {'ISO 6336':>12}   [1e8 N/m]"
    lines = [f"{head}  {'edge undeformed':>15} {'hot':>6}   [% of the period]"]
    for place, torque in enumerate(found["pinion_torque_Nm"]):
        springs = [found["mean_stiffness"][t][place] for t in (0, 1)]
        springs.append(found["iso_6336_stiffness"][place])
        cells = [_text(None if k is None else 1e-8 * k) for k in springs]
        edges = [found["edge_contact_share"][t][place] for t in (0, 1)]
        shares = ["-" if s is None else f"{100.0 * s:.1f}" for s in edges]
        lines.append(
            f"{torque:>10.4g} {cells[0]:>14} {cells[1]:>12} {cells[2]:>12}"
            f"{shares[0]:>23} {shares[1]:>6}"
        )
    _finish(tree, found, lines, Path(output) / "contact.html", as_json)


COMMANDS: tuple[click.Command, ...] = (friction, temperature, warmup, relief, contact)
"""For the main group to register."""


# --- what the commands share ----------------------------------------------------------------


def _gear_case(case: str, overrides: tuple[str, ...]) -> GearCase:
    from thermogear.case.case import gear_case, load_case

    return gear_case(load_case(Path(case), overrides))


def _carry_out(
    name: str, directory: Path, make: Callable[[Progress], xr.DataTree], quiet: bool
) -> xr.DataTree:
    """Claim the directory, compute, store, draw."""
    from thermogear.front.progress import progress
    from thermogear.results.files import claimed, write_results
    from thermogear.views.survey_report import write_survey

    with claimed(directory) as folder:
        with progress(wanted=not quiet) as report:
            tree = make(report)
        write_results(tree, folder, f"{name}.nc")
        write_survey(folder, name)
    return tree


def _finish(
    tree: xr.DataTree, found: dict[str, Any], lines: list[str], page: Path, as_json: bool
) -> None:
    notices = json.loads(tree.attrs["notices"])
    if as_json:
        content = {"title": tree.attrs["title"], **found, "notices": notices}
        click.echo(json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False))
        return
    for line in lines:
        click.echo(line)
    for notice in notices:
        click.echo(f"- {notice['text']}")
    click.echo(page)


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


def _operating(data: xr.Dataset) -> list[dict[str, float]]:
    pairs = zip(data["pinion_speed"].values, data["pinion_torque"].values, strict=True)
    return [{"pinion_speed_rpm": float(s) / RPM, "pinion_torque_Nm": float(t)} for s, t in pairs]


def _names(data: xr.Dataset) -> list[str]:
    return [
        f"{one['pinion_speed_rpm']:.0f} rpm {one['pinion_torque_Nm']:.4g} N m"
        for one in _operating(data)
    ]


def _finite(value: object) -> float | None:
    number = float(str(value))
    return number if math.isfinite(number) else None


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}"


def _reach(values: Any) -> str:
    """Least and greatest of ``values``, or the one there is; "-" without any."""
    known = [float(v) for v in values.ravel() if math.isfinite(v)]
    if not known:
        return "-"
    low, high = (f"{v:.4g}" for v in (min(known), max(known)))
    return low if low == high else f"{low} .. {high}"


def _table(data: xr.DataArray) -> list[list[float | None]]:
    return [[_finite(v) for v in row] for row in data.values]
