"""``bifurcation``, ``map``, ``basins``, ``runup``, ``waterfall`` and ``sweep`` to register.

Each works into a store directory: killed or stopped, the same command goes on where it was.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.front import delivery
from thermogear.front.motion_commands import is_train
from thermogear.front.numbers import grid, start
from thermogear.front.progress import Stopped, progress

if TYPE_CHECKING:
    from thermogear.base.plan import Plan
    from thermogear.case.case import DimensionlessCase, GearCase
    from thermogear.case.thermal_state import ThermalState
    from thermogear.results.result import Result
    from thermogear.results.work import Step
    from thermogear.study.diagrams import AnyMap


_common = delivery.together(
    delivery.output("Store of the results; the same command goes on with an unfinished one."),
    delivery.overrides,
    click.option("--bundle", help="Bundle of choices; default: the case's first."),
    click.option("--state", help="undeformed, hot (as the case says), computed (from the heat "
                 "balance) or the gears' temperature in degC; default: hot."),
    click.option("--threads", type=click.IntRange(1, 1024), help="Default: all cores."),
    click.option("--force", is_flag=True, help="Run even if it may not fit."),
    click.option("--estimate", "only_estimate", is_flag=True,
                 help="Print time, memory and disk it will take, and stop."),
    delivery.csv,
    delivery.as_json,
)  # fmt: skip
"""Options of every one of these commands."""


GEAR_AXES = (
    "A parameter and its values: rpm, torque, temperature, backlash, damping or a dotted field "
    "(gears.pinion.face_width=20 mm:30 mm:3) of a gear case"
)


_train = delivery.together(
    click.option("--rigid", is_flag=True,
                 help="The gear pair on rigid bearings, although CASE has [[shafts]]."),
    click.option("--operating", type=int, metavar="N",
                 help="Operating point of the drive train, from 1 [1]."),
    click.option("--coordinates", type=int, metavar="N",
                 help="Of the reduced train; the interface and 16 modes if left out."),
)  # fmt: skip
"""Options of the commands that move a drive train where the case has shafts."""


def _train_of(
    case: GearCase | DimensionlessCase, options: dict[str, Any], plane: str | None = None
) -> Any:
    """What is asked of the case's drive train; None where its gears alone are meant."""
    from thermogear.study.diagrams import Train

    asked = {n: options.pop(n) for n in ("operating", "coordinates")}
    if not is_train(case, options.pop("rigid"), {**asked, "plane": plane}):
        return None
    number = 1 if asked["operating"] is None else asked["operating"]
    seen = "" if plane in (None, "teeth") else plane or " "
    return Train(operating=number - 1, coordinates=asked["coordinates"], seen=seen)


def _over(words: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    return click.option(
        "--over", multiple=True, required=True, metavar="NAME=FROM:TO:COUNT", help=words
    )


_parts = click.option(
    "--parts", type=int, metavar="N",
    help="Pairs of the series of a case with a class: 16 to 1024, 1: none. Default: of a run-up as "
    "many as the case states, at each point of a sweep 16, which cost 0.1 to 0.9 s there.",
)  # fmt: skip


_but = click.option(
    "--but",
    multiple=True,
    metavar="NAME=VALUE",
    help="Change a number of a dimensionless base set. May be repeated.",
)


@click.command()
@delivery.case
@_over(f"{GEAR_AXES}; zeta, omega, epsilon, F_m, F_h, b, eps_T of a dimensionless one.")
@_but
@click.option("--start", "starts", multiple=True, metavar="X,V",
              help="A start in half backlashes. May be repeated.")  # fmt: skip
@click.option("--branch-period", type=click.IntRange(0, 64), default=4, show_default=True,
              help="Follow branches of orbits up to this period; 0: none.")  # fmt: skip
@_train
@_common
def bifurcation(
    case: str, over: tuple[str, ...], but: tuple[str, ...], starts: tuple[str, ...],
    branch_period: int, output: str, as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Orbit diagram of CASE over one parameter, up and down, with located bifurcations."""
    from thermogear.case.axes import parse_axis, parse_numbers
    from thermogear.study.diagrams import case_diagram

    read = _of_mean_tooth(delivery.load(case, options["overrides"]), options, over)
    if len(over) != 1:
        raise InputError("over", f"{len(over)} parameters", allowed="one for a diagram")
    name, values = parse_axis(read, over[0])
    delivery.heat_once([name], options["state"])
    begin = tuple(map(start, starts))
    bundle, state = _choice(read, options)
    plan = case_diagram(
        read, name, values, bundle=bundle, state=state, changes=parse_numbers(but),
        branch_period=branch_period, starts=begin, train=_train_of(read, options),
    )  # fmt: skip
    _carry(plan, Path(output), read.title, as_json, options)


@click.command("map")
@delivery.case
@_over(f"{GEAR_AXES}; zeta, omega, epsilon, F_m, F_h, b, eps_T of a dimensionless one.")
@_but
@click.option("--full", is_flag=True,
              help="Compute every point; without it points whose neighbours are alike are assumed "
              "where all would take more than two minutes.")  # fmt: skip
@click.option(
    "--borders",
    is_flag=True,
    help="Follow the borders at which a flank or a bearing begins to part, as curves.",
)
@_train
@_common
def map_(
    case: str,
    over: tuple[str, ...],
    but: tuple[str, ...],
    full: bool,
    borders: bool,
    output: str,
    as_json: bool,
    **options: Any,
) -> None:
    """Map of the regimes of CASE over two parameters (--over twice).

    Of a drive train also what loses contact; undeformed and hot, where neither --state nor --over
    says how hot.
    """
    from thermogear.case.axes import parse_axes, parse_numbers
    from thermogear.case.samples import GEARS_AT
    from thermogear.results.work import require_space
    from thermogear.study.diagrams import case_map, train_maps, whole_or_spared

    read = _of_mean_tooth(delivery.load(case, options["overrides"]), options, over)
    if len(over) != 2:
        raise InputError("over", f"{len(over)} parameters", allowed="two for a map")
    axes = parse_axes(read, over)
    delivery.heat_once(axes, options["state"])
    bundle, state = _choice(read, options)
    changes, train = parse_numbers(but), _train_of(read, options)
    plan: AnyMap
    if train is None or changes or GEARS_AT in axes or options["state"] is not None:
        plan = case_map(
            read, axes, bundle=bundle, state=state, changes=changes, train=train, borders=borders
        )
    else:
        plan = train_maps(read, axes, bundle=bundle, train=train, borders=borders)
    if not full:
        require_space(plan, Path(output), threads=options["threads"], forced=options["force"])
        plan, options["estimated"] = whole_or_spared(plan, Path(output), threads=options["threads"])
    _carry(plan, Path(output), read.title, as_json, options)


@click.command()
@delivery.case
@_but
@click.option(
    "--along",
    metavar="NAME=FROM:TO:COUNT",
    help="Shares of random starts over this parameter, and what leaves each motion.",
)
@click.option("--x", "x", metavar="FROM:TO:COUNT",
              help="Starts; -2:2:401, of a drive train -2:2:25. With --along the box of the random "
              "starts, as many as a grid has: -2:2:20, of a drive train -2:2:8.")  # fmt: skip
@click.option("--v", "v", metavar="FROM:TO:COUNT", help="As --x.")
@click.option("--plane", metavar="NAME",
              help="Of a drive train: a bearing, whose journal starts at (x, v) in um, or "
              "teeth, deflection and rate in half backlashes [teeth].")  # fmt: skip
@_train
@_common
def basins(
    case: str, but: tuple[str, ...], along: str | None, x: str | None, v: str | None,
    plane: str | None, output: str, as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Basins of attraction of CASE at its base set (a gear case: first speed and torque).

    With --along the share of random starts that ends on each motion, with its 95 % interval, and
    the least displacement and change of velocity that leave it.
    """
    from thermogear.case.axes import parse_axis, parse_numbers
    from thermogear.study.diagrams import case_basin_shares, case_basins

    read = _of_mean_tooth(delivery.load(case, options["overrides"]), options)
    bundle, state = _choice(read, options)
    train = _train_of(read, options, plane)
    counts = ("401", "25") if along is None else ("20", "8")
    usual = f"-2:2:{counts[train is not None]}"
    make: Callable[..., Plan] = case_basins
    if along is not None:
        name, values = parse_axis(read, along, "along")
        delivery.heat_once([name], options["state"])
        make = partial(case_basin_shares, name=name, values=values)
    plan = make(
        read, x=grid("x", x or usual), v=grid("v", v or usual), bundle=bundle, state=state,
        changes=parse_numbers(but), train=train,
    )  # fmt: skip
    _carry(plan, Path(output), read.title, as_json, options)


@click.command()
@delivery.case
@click.option("--rpm", default="200:12000:119", show_default=True, metavar="FROM:TO:COUNT")
@click.option("--hot", multiple=True, metavar="DEGC",
              help="Gear temperature beside undeformed; as --state says if left out.")  # fmt: skip
@click.option("--torque", type=float, metavar="NM", help="The case's first if left out.")
@click.option("--branch-period", type=click.IntRange(0, 16), default=2, show_default=True,
              help="Locate folds on branches up to this period; 0: none.")  # fmt: skip
@_parts
@_common
def runup(
    case: str,
    rpm: str,
    hot: tuple[str, ...],
    torque: float | None,
    branch_period: int,
    parts: int | None,
    output: str,
    as_json: bool,
    **options: Any,
) -> None:
    """Run CASE up and down in speed, without heat and hot: error, mesh force, K_v, jumps.

    Of a case in series (a class, no seed) the band of its pairs is drawn behind the one followed.
    """
    from thermogear.case.thermal_state import UNDEFORMED, ThermalState
    from thermogear.study.run_up import run_up_plan

    read = delivery.load_gears(case, options["overrides"])
    _of_mean_tooth(read, options, over_speeds=True)
    speeds = grid("rpm", rpm) * RPM
    bundle, state = _choice(read, options)
    if hot and options["state"] is not None:
        raise InputError("--state", options["state"], why="beside --hot", fix="leave one out")
    warm = [ThermalState.parse(text, "--hot") for text in hot] or [state]
    plan = run_up_plan(
        read, speeds, temperatures=list(dict.fromkeys((UNDEFORMED, *warm))), bundle=bundle,
        torque=torque, branch_period=branch_period, parts=parts,
    )  # fmt: skip
    _carry(plan, Path(output), read.title, as_json, options)


@click.command()
@delivery.case
@_over(f"{GEAR_AXES}.")
@_parts
@_common
def sweep(
    case: str, over: tuple[str, ...], parts: int | None, output: str, as_json: bool, **options: Any
) -> None:
    """Settled motion, mesh force and K_v of a gear CASE over any grid of parameters.

    Of a case in series (a class and no seed) also the median and band of its pairs at each point.
    """
    from thermogear.case.axes import parse_axes
    from thermogear.study.sweep import sweep_plan

    read = delivery.load_gears(case, options["overrides"])
    _of_mean_tooth(read, options, over, over_speeds=True)
    axes = parse_axes(read, over)
    delivery.heat_once(axes, options["state"])
    bundle, state = _choice(read, options)
    plan = sweep_plan(read, axes, bundle=bundle, state=state, parts=parts)
    _carry(plan, Path(output), read.title, as_json, options)


@click.command()
@delivery.case
@click.option("--rpm", default="1000:6000:64", show_default=True, metavar="FROM:TO:COUNT")
@click.option("--operating", type=int, metavar="N",
              help="Point that gives torque, heat and mesh; the hardest if left out.")  # fmt: skip
@click.option("--seconds", type=float, default=20.0, show_default=True,
              help="How long one way takes.")  # fmt: skip
@click.option("--coordinates", type=int, metavar="N",
              help="Of the reduced train; the interface and 16 modes if left out.")  # fmt: skip
@_common
def waterfall(
    case: str,
    rpm: str,
    operating: int | None,
    seconds: float,
    coordinates: int | None,
    output: str,
    as_json: bool,
    **options: Any,
) -> None:
    """Run CASE's drive train up and down: forces, sound of the housing, orders, jumps.

    With clearance in teeth and bearings, undeformed and hot. CASE needs [[shafts]] and
    [[bearings]].
    """

    from thermogear.case.family import GearFamily
    from thermogear.case.thermal_state import UNDEFORMED
    from thermogear.study.shafts.waterfall import waterfall_plan

    read = _of_mean_tooth(delivery.load_gears(case, options["overrides"]), options)
    speeds = grid("rpm", rpm) * RPM
    bundle, state = _choice(read, options)
    model = GearFamily(read, ("pinion_speed",), bundle).model
    plan = waterfall_plan(
        replace(read, models=(model,)), speeds,
        states=list(dict.fromkeys((UNDEFORMED, state))), operating=operating,
        duration=seconds, coordinates=coordinates, threads=options["threads"],
    )  # fmt: skip
    _carry(plan, Path(output), read.title, as_json, options)


@click.command()
@delivery.case
@click.option("--parts", type=int, default=16, show_default=True, metavar="N",
              help="Pairs of the class that get each fault, 8 to 60.")  # fmt: skip
@click.option("--noise", type=float, default=0.3, show_default=True, metavar="SHARE",
              help="Noise over the rms of the first healthy pair, white; chosen.")  # fmt: skip
@click.option("--turns", type=int, default=100, show_default=True, metavar="N",
              help="Turns of the pinion in an average, about; chosen.")  # fmt: skip
@delivery.output("Store of the results; the same command goes on with an unfinished one.")
@delivery.overrides
@click.option("--bundle", help="Bundle of choices; default: the case's first.")
@click.option("--threads", type=click.IntRange(1, 1024), help="Default: all cores.")
@click.option("--force", is_flag=True, help="Run even if it may not fit.")
@click.option("--estimate", "only_estimate", is_flag=True,
              help="Print time, memory and disk it will take, and stop.")  # fmt: skip
@delivery.as_json
def detect(
    case: str, parts: int, noise: float, turns: int, bundle: str | None, output: str,
    as_json: bool, **options: Any,
) -> None:  # fmt: skip
    """Which indicator sees a fault of CASE, of which size, at which load, hot and cold.

    Drawn pairs of the case's class run over their whole turn with each fault of [[faults]] alone,
    at a quarter, half and all of its size, and without: four usual faults where the case states
    none. Loads are the case's torques, or .5, 1 and 1.5 times the one it has. The indicators of
    `diagnose` are held against limits of healthy averages, of the same machine and of other pairs
    of the class.
    """
    from thermogear.study.detection import detection_plan

    read = delivery.load_gears(case, options["overrides"])
    plan = detection_plan(read, bundle=bundle or "", parts=parts, noise=noise, turns=turns)
    _carry(plan, Path(output), read.title, as_json, options)


COMMANDS: tuple[click.Command, ...] = (bifurcation, map_, basins, runup, waterfall, sweep, detect)
"""What the main group registers."""


# --- from words to values -----------------------------------------------------------------


def _choice(
    case: GearCase | DimensionlessCase, options: dict[str, Any]
) -> tuple[str, ThermalState]:
    """Bundle and state of heat; refused beside a case without gears."""
    from thermogear.case.thermal_state import HOT, ThermalState

    for name in ("bundle", "state"):
        if options[name] is not None and case.kind != "gear":
            raise InputError(
                f"--{name}", options[name], why="a dimensionless case has no gears",
                fix="leave it out",
            )  # fmt: skip
    said = options["state"]
    return options["bundle"] or "", HOT if said is None else ThermalState.parse(said, "--state")


# --- running ------------------------------------------------------------------------------


def _of_mean_tooth(
    case: Any, options: dict[str, Any], over: Sequence[str] = (), *, over_speeds: bool = False
) -> Any:
    """The case with the mean tooth of its gears, unless it states its period; notices say so."""
    from thermogear.study.declared import fault_notices, mean_tooth_notices

    if case.kind != "gear":
        return case
    taken = case.over_speeds() if over_speeds else case.unless_stated("period", "mesh")
    options["notices"] = (
        *fault_notices(taken, varied=[text.partition("=")[0].strip() for text in over]),
        *mean_tooth_notices(case, taken),
    )
    return taken


def _estimate_alone(options: dict[str, Any], as_json: bool) -> None:
    if options["only_estimate"] and as_json:
        raise InputError("--json", "beside --estimate", why="an estimate is a sentence")


def _compute(plan: Plan, directory: Path, title: str, options: dict[str, Any]) -> Result | None:
    """Carry ``plan`` out and draw its page; None where only an estimate was wanted."""
    from thermogear.front.lines import say
    from thermogear.results.work import carry_out, estimate, require_space

    require_space(plan, directory, threads=options["threads"], forced=options["force"])
    if options["only_estimate"] or sys.stderr.isatty():
        say("estimate", options.get("estimated") or estimate(plan, threads=options["threads"]))
    if options["only_estimate"]:
        return None
    last: list[Step] = []
    begun = time.monotonic()
    try:
        with progress() as watch:
            # what is left to do behind the chunks has its own stages
            plan = getattr(plan, "telling", lambda _: plan)(watch)

            def report(step: Step) -> None:
                last[:] = [step]
                watch("chunks", step.done, step.total)

            data = carry_out(
                plan, directory, threads=options["threads"], report=report,
                forced=options["force"], title=title,
            )  # fmt: skip
        from thermogear.base.stores import about_store
        from thermogear.study.notices import finished
        from thermogear.views.write import page_of, write

        about = {name: value for name, value in about_store(directory).items() if name != "title"}
        about |= {"interrupted": 1} if data.attrs.get("borders_cut") else {}
        result = finished(data, title).with_(**about, seconds=round(time.monotonic() - begun, 3))
        notices = (*options.get("notices", ()), *result.notices)
        result = replace(result, notices=tuple(dict.fromkeys(notices)))
        write(delivery.without_hidden(page_of(result)), directory)
    except KeyboardInterrupt:
        if not last:
            raise Stopped(f"nothing was added to {directory}") from None
        raise Stopped(
            f"{last[0].done} of {last[0].total} chunks stay in {directory}, the same command goes "
            "on from there"
        ) from None
    return result


def _carry(plan: Plan, directory: Path, title: str, as_json: bool, options: dict[str, Any]) -> None:
    """Compute, draw, and print."""
    from thermogear.views.write import page_of

    _estimate_alone(options, as_json)
    result = _compute(plan, directory, title, options)
    if result is not None:
        delivery.put_csv(result)
        delivery.tell(page_of(result), directory / "report.html", as_json=as_json)
        if result.interrupted:
            raise Stopped(
                f"the borders followed so far are in {directory}, the same command "
                "follows all of them"
            )
