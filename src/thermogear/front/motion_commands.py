"""``thermogear continue``, and the options that pick one motion.

It works on a case file (gear or dimensionless, or the name of a ready-made one) or on plain
numbers. Importing this module imports nothing heavy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

from thermogear.base.errors import InputError
from thermogear.base.parameters import NUMBERS, PARAMETERS, Parameter
from thermogear.base.progress import Progress
from thermogear.front import delivery
from thermogear.front.numbers import start

if TYPE_CHECKING:
    from thermogear.case.one_point import OnePoint
    from thermogear.results.result import Result

_Command = TypeVar("_Command", bound=Callable[..., Any])

DEFAULTS = {"half_backlash": " over the cold one [1]", "thermal_stiffness": " [0]"}
"""What is said of numbers that may be left out."""
OF_GEARS = ("operating", "bundle", "state")
OF_ROWS = ("row", "point")


def _number(parameter: Parameter) -> Callable[[_Command], _Command]:
    """The option of a number of the equation; its other names work as well."""
    short, *others = (alias.replace("_", "-") for alias in parameter.aliases)
    words = f"{parameter.words}{DEFAULTS.get(parameter.name, '')}"
    also = ", ".join(f"--{name}" for name in others)
    text = f"{words}{f'; also {also}' if also else ''}."
    return click.option(f"--{short}", parameter.name, type=float, help=text)


point_options = delivery.together(
    click.argument("case", metavar="[CASE]", required=False),
    *(_number(PARAMETERS[name]) for name in NUMBERS),
    click.option("--start", metavar="X,V", help="Start (X, X') instead of the case's."),
    click.option("--row", metavar="NAME", help="Row of a dimensionless case [the first]."),
    click.option("--point", type=int, help="Point of the row, from 1 [1]."),
    click.option(
        "--operating", type=int,
        help="Operating point of a gear case, from 1 (speeds x torques) [1].",
    ),
    click.option("--bundle", metavar="NAME", help="Bundle of a gear case [the first]."),
    click.option(
        "--state",
        help="undeformed | hot | computed | the gears' temperature in degC [hot]. Along speed "
        "and torque the gears stay as hot as at the operating point.",
    ),
    delivery.overrides,
    delivery.output("Also store data, pictures and a page.", required=False),
    delivery.as_json,
)  # fmt: skip
"""CASE and the options that pick one motion out of it, or plain numbers."""


def _start(options: dict[str, Any]) -> tuple[float, float] | None:
    return None if options["start"] is None else start(options["start"])


def _numbers(options: dict[str, Any]) -> dict[str, float]:
    """The given numbers of the equation, by their long names."""
    return {name: float(options[name]) for name in NUMBERS if options[name] is not None}


def _unused(options: dict[str, Any], names: Sequence[str], why: str) -> None:
    """Refuse options that would change nothing."""
    for name in names:
        if options[name]:
            raise InputError(f"--{name}", options[name], why=why, fix="leave it out")


def _case(options: dict[str, Any]) -> Any:
    """The case named on the command line: a file, or a ready-made one; None without."""
    name = options["case"]
    if name is None:
        if options["overrides"]:
            raise InputError(
                "--set, --turn or --part", options["overrides"][0], why="no case is named"
            )
        return None
    return delivery.load(name, options["overrides"])


def _point(options: dict[str, Any], case: Any) -> OnePoint:
    from thermogear.case.one_point import of_case, of_numbers
    from thermogear.case.thermal_state import HOT, ThermalState

    start, numbers = _start(options), _numbers(options)
    if case is None:
        _unused(options, (*OF_ROWS, *OF_GEARS), "no case is named")
        return of_numbers(numbers, start)
    if case.kind == "gear":
        _unused(options, OF_ROWS, "a gear case has no rows")
    else:
        _unused(options, OF_GEARS, "a dimensionless case has no gears")
    said = options["state"]
    return of_case(
        case,
        row=options["row"],
        point=options["point"],
        operating=options["operating"],
        bundle=options["bundle"],
        state=HOT if said is None else ThermalState.parse(said, "--state"),
        numbers=numbers,
        start=start,
    )


def point_of(options: dict[str, Any]) -> OnePoint:
    """The one motion that the options pick."""
    return _point(options, _case(options))


@click.command("continue")
@point_options
@click.option(
    "--parameter",
    metavar="NAME",
    help="zeta, w, ...; speed, torque, temperature, backlash, or a dotted field of a gear case.",
)
@click.option("--from", "begin", metavar="VALUE", help="Where to begin [the present value].")
@click.option("--to", metavar="VALUE", help="Where to end; gear values with unit: '4000 rpm'.")
@click.option("--period", type=int, help="Mesh periods of the orbit [what the motion settles on].")
@click.option("--direct", is_flag=True, help="Newton from the start itself.")
@click.option(
    "--switch", type=int, default=0, show_default=True,
    help="Follow doubled branches at flips, so many levels deep.",
)  # fmt: skip
@click.option(
    "--and", "second", metavar="NAME=FROM:TO:COUNT",
    help="A second parameter: every fold, doubling, pitchfork, torus point and grazing found at "
    "FROM is followed to TO, as a curve in the plane of both.",
)  # fmt: skip
@click.option(
    "--rigid", is_flag=True, help="The gear pair on rigid bearings, although CASE has [[shafts]]."
)
@click.option(
    "--coordinates", type=int, metavar="N",
    help="Of the reduced train; the interface and 16 modes if left out.",
)  # fmt: skip
@click.option(
    "--values", type=click.IntRange(2, 1000), metavar="N",
    help="Values of the parameter at which a train's mesh, bearings and friction are computed; "
    "straight between them [9].",
)  # fmt: skip
def continue_(
    parameter: str | None,
    begin: str | None,
    to: str | None,
    period: int | None,
    direct: bool,
    switch: int,
    second: str | None,
    rigid: bool,
    coordinates: int | None,
    values: int | None,
    **options: Any,
) -> None:
    """Follow an orbit in a parameter; locate folds, flips, pitchforks, tori and grazing.

    The drive train's orbit where CASE has [[shafts]], else that of the gear pair.

    \b
    fold             the branch turns back: the motion jumps there
    period doubling  supercritical: the doubled motion takes over smoothly; subcritical: it
                     jumps; vertical: the linear motion in contact becomes unstable
    pitchfork        a symmetric motion loses its symmetry
    torus            of a drive train: a second frequency begins (Neimark-Sacker)
    grazing          the motion just touches an edge of the gap: contacts begin or end

    \b
      thermogear continue table-4.2 --parameter zeta --to 0.1 --switch 3
      thermogear continue rig.toml --parameter speed --to "6000 rpm" -o branches
      thermogear continue --zeta 0.18 --w 1.245 --eps 0.335 --fm 0.017 --fh -1.16 \\
        --parameter zeta --to 0.10 --switch 2
      thermogear continue own.toml --parameter speed --from "2000 rpm" --to "4000 rpm" \\
        --and "temperature=20 degC:100 degC:5" -o jumps
    """
    from thermogear.case.one_point import parameter_name, parameter_value
    from thermogear.study.branches import branch_results

    case = _case(options)
    train = is_train(case, rigid, {"coordinates": coordinates, "values": values})
    if parameter is None or to is None:
        missing = "--parameter" if parameter is None else "--to"
        raise InputError(missing, "nothing", fix="for instance --parameter zeta --to 0.1")
    point = _point(options, case)
    name = parameter_name(point, parameter)
    end = parameter_value("--to", point, name, to)
    first = None if begin is None else parameter_value("--from", point, name, begin)
    plane = None if second is None else _second(point, name, second)

    def make(report: Progress) -> Result:
        if train:
            from thermogear.study.shafts.branches import VALUES, Trains, train_branch_results

            trains = Trains.of(case, point, operating=options["operating"], coordinates=coordinates)
            return train_branch_results(
                trains, name, end, begin=first, start=_start(options), period=period,
                transient=not direct, switch=switch, count=VALUES if values is None else values,
                second=plane, progress=report,
            )  # fmt: skip
        return branch_results(
            point, name, end, start=first, period=period, transient=not direct, switch=switch,
            second=plane, progress=report,
        )  # fmt: skip

    delivery.deliver(make, options["output"], as_json=options["as_json"])


def is_train(case: Any, rigid: bool, asked: dict[str, Any]) -> bool:
    """Whether the case's drive train moves; options of one are refused without it."""
    has = getattr(case, "train", None) is not None
    if rigid and not has:
        raise InputError(
            "--rigid", "without shafts", why="CASE has no [[shafts]]", fix="leave it out"
        )
    if has and not rigid:
        return True
    for name, value in asked.items():
        if value is not None:
            why = "--rigid leaves the shafts out" if rigid else "CASE has no [[shafts]]"
            raise InputError(f"--{name}", value, why=why, fix="leave it out")
    return False


def _second(point: OnePoint, first: str, text: str) -> tuple[str, Any]:
    """Name and values of a second parameter, as no case file would refuse them."""
    from thermogear.case.axes import parse_axis

    name, values = parse_axis(point.case, text, "--and")
    if name == first:
        raise InputError("--and", repr(text), why="it is --parameter", fix="name another one")
    if values.size < 2 or values[0] == values[-1]:
        raise InputError("--and", repr(text), allowed="two values or more, from one to another")
    return name, values


COMMANDS: list[click.Command] = [continue_]
