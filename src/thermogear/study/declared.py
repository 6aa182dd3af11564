"""Studies that are declared once: their arguments, their options, and what is stored of them.

A study is a frozen dataclass. Its fields are the keyword arguments of the function that carries it
out; :func:`option` says how the command line takes each and what is allowed. The docstring is the
help of the command. Importing this module imports nothing heavy: ``--help`` reads it.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, field, fields, replace
from functools import partial, wraps
from importlib import import_module
from itertools import pairwise
from numbers import Integral
from typing import TYPE_CHECKING, Any, ClassVar, ParamSpec, TypeVar

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM

if TYPE_CHECKING:
    from thermogear.base.notice import Notice
    from thermogear.case.case import GearCase
    from thermogear.results.result import Result

P = ParamSpec("P")
T = TypeVar("T")


def option(
    default: T,
    flag: str,
    words: str,
    *,
    read: Callable[[str, Any], Any] | None = None,
    allowed: range | Sequence[str] = (),
    bounds: str = "",
    **more: Any,
) -> T:
    """A field: its ``default`` in SI, and its option ``flag`` with the ``words`` of its help.

    ``read(flag, value)`` makes an SI value of what a person wrote. ``allowed`` are whole numbers of
    a range, or these words, from Python too; ``bounds``: of :mod:`~thermogear.base.bounds`, by its
    name there, likewise. ``more``: metavar and type.
    """
    about = {"flag": flag, "help": words, "read": read, "allowed": allowed, "bounds": bounds}
    declared: T = field(default=default, metadata=about | more)
    return declared


class Study:
    """What is asked of a study: every subclass is a frozen dataclass of one.

    ``home``: module and name of the function that carries it out; ``of``: what it is a study of,
    the gears or one point of a case. A directory of results may be left out where there are words
    on it, ``stores``. ``mean_tooth``: it takes one mesh period of gears whose teeth differ,
    "always" or "unless stated" otherwise by the case. ``sound``: it leaves the case's faults out.
    """

    kind: ClassVar[str]
    home: ClassVar[str]
    of: ClassVar[str]
    stores: ClassVar[str]
    mean_tooth: ClassVar[str]
    sound: ClassVar[bool]

    def __init_subclass__(
        cls,
        kind: str,
        home: str,
        of: str = "gears",
        stores: str = "",
        mean_tooth: str = "",
        sound: bool = False,
    ) -> None:
        cls.kind, cls.home, cls.of, cls.stores = kind, home, of, stores
        cls.mean_tooth, cls.sound = mean_tooth, sound

    def __post_init__(self) -> None:
        for each in fields(self):  # type: ignore[arg-type]  # subclasses are dataclasses
            value = getattr(self, each.name)
            if value is not each.default:
                _require(each, value)

    def arguments(self, subject: Any) -> dict[str, Any]:
        """The keyword arguments of the function, for this case or point."""
        return dict(vars(self))

    def of_subject(self, subject: Any) -> Callable[[Progress], Result]:
        """What carries the study out, with its arguments, which are checked."""
        module, _, name = self.home.partition(":")
        study, arguments = getattr(import_module(module), name), self.arguments(subject)

        def carried_out(progress: Progress) -> Result:
            made: Result = study(subject, **arguments, progress=progress)
            return made.with_(asked=self.asked(arguments))

        return carried_out

    def asked(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Fields and ``arguments`` as results store them, the latter where they differ.

        Tables and records stand in the groups of a result.
        """
        plain = ((k, _plain(v)) for k, v in (*vars(self).items(), *arguments.items()))
        return {name: value for name, value in plain if value is not None}


def fault_notices(
    case: GearCase, *, sound: bool = False, about: str = "", varied: Sequence[str] = ()
) -> Iterator[Notice]:
    """The faults that a study of ``case`` takes, and those of its file that it leaves out.

    ``sound``: it takes none of them; ``about``: which of its parts that is said of; ``varied``:
    the names of parameters that are put to other values.
    """
    from thermogear.base.notice import Notice

    acting = [] if sound else case.faults()
    if acting:
        deaf = [model.name for model in case.models if model.stiffness != "loaded"]
        yield Notice.of(
            "fault_taken", about=about, faults="; ".join(acting), deaf=deaf or None,
            varied=sorted(name for name in varied if name.startswith("faults.")) or None,
        )  # fmt: skip
    left = [words for words in case.all_faults if words not in acting]
    if left:
        yield Notice.of("fault_left_out", about=about, faults="; ".join(left))


def mean_tooth_notices(case: GearCase, taken: GearCase) -> Iterator[Notice]:
    """That a study has ``taken`` the mean tooth of a ``case`` whose teeth differ."""
    from thermogear.base.notice import Notice

    if case.period.mesh_periods > taken.period.mesh_periods:
        yield Notice.of("mean_tooth_taken", mesh_periods=case.period.mesh_periods)


def declared(study: type[Study]) -> Callable[[Callable[P, Result]], Callable[P, Result]]:
    """A function whose arguments ``study`` declares: checks them, and stores them as asked."""
    names = {each.name for each in fields(study)}  # type: ignore[arg-type]

    def checked(function: Callable[P, Result]) -> Callable[P, Result]:
        signature = inspect.signature(function)

        @wraps(function)
        def studied(*args: P.args, **kwargs: P.kwargs) -> Result:
            bound = signature.bind(*args, **kwargs)
            given = bound.arguments
            asked = study(**{name: given[name] for name in names & given.keys()})
            notices: tuple[Notice, ...] = ()
            subject = next(iter(given))
            if study.of == "gears":
                from thermogear.case.case import gear_case

                given_case = gear_case(given[subject])
                case = taken = given_case.sound() if study.sound else given_case
                if study.mean_tooth:
                    always = study.mean_tooth == "always"
                    taken = case.mean_tooth() if always else case.unless_stated("period", "mesh")
                given[subject] = taken
                faults = fault_notices(given_case if study.sound else taken, sound=study.sound)
                notices = (*faults, *mean_tooth_notices(case, taken))
            elif given[subject].operating is not None:
                case = given[subject].gears
                taken = case.mean_tooth() if study.mean_tooth else case
                notices = (*fault_notices(taken), *mean_tooth_notices(case, taken))
            result = function(*bound.args, **bound.kwargs).with_(asked=asked.asked({}))
            return replace(result, notices=(*notices, *result.notices))

        return studied

    return checked


def _require(asked: Field[Any], value: Any) -> None:
    """Refuse what the type of a field, its words or its bounds do not take.

    Texts without such words name files, which a study reads or refuses itself.
    """
    allowed, kind = asked.metadata["allowed"], str(asked.type).removesuffix(" | None")
    words = f"{allowed[0]}..{allowed[-1]}" if isinstance(allowed, range) else " | ".join(allowed)
    if kind == "int" and (isinstance(value, bool) or not isinstance(value, Integral)):
        words = f"{words}, a whole number".removeprefix(", ")
    elif kind == "Sequence[str]" and not isinstance(value, list | tuple):
        words = "a list of names"
    elif not allowed or value in list(allowed):
        words = ""
    if words:
        raise InputError(asked.name, repr(value), allowed=words)
    if not asked.metadata["bounds"]:
        return
    from thermogear.base import bounds

    limits = getattr(bounds, asked.metadata["bounds"])
    several = hasattr(value, "__len__") and not isinstance(value, str)
    if kind == "float" or (kind.startswith("float |") and not several):
        limits.require_number(asked.name, value)
        return
    shape = bounds.floats(asked.name, value, limits.si).shape
    if len(shape) != 1 or shape == (0,) or (kind.startswith("tuple") and shape != (2,)):
        words = "two numbers" if kind.startswith("tuple") else "one number or more, on one axis"
        raise InputError(asked.name, repr(value), allowed=f"{words} [{limits.si}]")
    limits.require(asked.name, value)


def _plain(value: Any) -> Any:
    """Words, numbers and rows of them; None for anything else."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value if isinstance(value, str | int | float) else None


# --- from words to values ---------------------------------------------------------------------


def numbers(
    flag: str,
    text: str,
    sign: str = ",",
    allowed: str = "numbers with commas between",
    fix: str = "500,1000,2000",
    count: int = 0,
) -> list[float]:
    """Numbers with a ``sign`` between; so many of them, or any number."""
    try:
        values = [float(part) for part in text.split(sign)]
    except ValueError:
        values = []
    if not values or len(values) != (count or len(values)):
        raise InputError(flag, repr(text), allowed=allowed, fix=f"write {fix}")
    return values


def _positive(flag: str, value: float, scale: float = 1.0) -> float:
    """A number above 0 in units of ``scale`` [SI]."""
    if not 0.0 < value < 1e9:
        raise InputError(flag, f"{value:g}", allowed="> 0, below 1e9")
    return scale * value


def _axis(flag: str, text: str, scale: float = 1.0) -> tuple[float, ...]:
    """Rising SI values of an axis: numbers with commas, or FROM:TO:COUNT."""
    if ":" not in text:
        values = numbers(flag, text)
    else:
        allowed, fix = "FROM:TO:COUNT, COUNT 2..100000", "500:6000:12"
        low, high, number = numbers(flag, text, ":", allowed, fix, 3)
        if not (2.0 <= number <= 100_000.0 and number.is_integer()):
            raise InputError(flag, repr(text), allowed=allowed, fix=f"write {fix}")
        values = [low + (high - low) * k / (number - 1.0) for k in range(int(number))]
    scaled = tuple(_positive(flag, value, scale) for value in values)
    if any(b <= a for a, b in pairwise(values)):
        raise InputError(flag, repr(text), allowed="strictly rising values")
    return scaled


def _file(flag: str, name: str) -> str:
    if not name.strip():
        raise InputError(flag, repr(name), allowed="the name of a file")
    return name


def _kelvin(flag: str, celsius: float) -> float:
    from thermogear.case.allowed import kelvin

    return kelvin(flag, celsius)


def _kelvins(flag: str, celsius: Sequence[float]) -> float | list[float] | None:
    return _of_many([_kelvin(flag, value) for value in celsius])


def _torques(flag: str, texts: Sequence[str]) -> float | list[float] | None:
    """Bare numbers are N m."""
    from thermogear.case.units import read_quantity

    def torque(text: str) -> float:
        try:
            return float(text)
        except ValueError:
            try:
                return read_quantity(text, "torque")
            except InputError as error:
                raise error.named(flag) from error

    return _of_many([torque(text) for text in texts])


def _of_many(values: list[float]) -> float | list[float] | None:
    """What an option that may be repeated gives: a single value as itself."""
    return values[0] if len(values) == 1 else values or None


def _range(flag: str, text: str) -> tuple[float, ...]:
    """LOW:HIGH rpm as [rad/s]."""
    return tuple(RPM * rpm for rpm in numbers(flag, text, ":", "LOW:HIGH", f"{flag} 0:6000", 2))


# --- gears ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Answers(
    Study,
    kind="answers",
    home="thermogear.study.answers.survey:answers",
    stores="Directory for results and a page of the answers.",
):
    """Answer what one wants to know of CASE: each in a sentence with its limit and a verdict.

    Does it mesh, how hot does it run, what is left of the backlash, is there a film, at which
    speeds does it resonate or lose contact, how large are dynamic factor and transmission error,
    how much the teeth's roots carry.
    """


@dataclass(frozen=True)
class Friction(Study, kind="friction", home="thermogear.study.friction:friction_survey"):
    """Draw every friction law over CASE's path of contact, with ranges and regime.

    Writes friction.nc, friction.html, pictures and CSV to DIR.
    """


@dataclass(frozen=True, kw_only=True)
class Temperature(Study, kind="temperature", home="thermogear.study.temperature:thermal_map"):
    """Close the loop of friction and heat over speeds and torques: the map of everything hot.

    Regime, flash and body temperature, backlash left, scuffing margin. Steady states alone:
    `warmup` follows the way there. Temperatures that CASE gives are not used; nodes that
    [gearbox.measured] holds are. Writes temperature.nc, temperature.html, pictures and CSV.
    """

    speeds: Sequence[float] = option(
        tuple(RPM * rpm for rpm in range(500, 6001, 500)),
        "--speeds",
        "Pinion speeds, or FROM:TO:COUNT; 500:6000:12 if left out.",
        read=partial(_axis, scale=RPM),
        bounds="SPEED",
        metavar="RPM[,RPM...]",
    )
    torques: Sequence[float] = option(
        tuple(map(float, range(50, 501, 50))),
        "--torques",
        "Pinion torques, or FROM:TO:COUNT; 50:500:10 if left out.",
        read=_axis,
        bounds="TORQUE",
        metavar="NM[,NM...]",
    )
    own: bool = option(False, "--own", "Take the speeds and torques of the case instead.")
    force: bool = option(False, "--force", "Run even if it may not fit into the free memory.")

    def arguments(self, subject: Any) -> dict[str, Any]:
        """The axes; refused where the map of so many points does not fit into the memory."""
        from thermogear.case.size import require_points

        axes = {"speeds": self.speeds, "torques": self.torques}
        if self.own:
            if axes != {name: getattr(Temperature, name) for name in axes}:
                raise InputError("own", "speeds or torques beside it", fix="leave one out")
            axes = {name: getattr(subject, name) for name in axes}
        require_points(math.prod(map(len, axes.values())), forced=self.force)
        return axes


@dataclass(frozen=True, kw_only=True)
class WarmUpSurvey(Study, kind="warmup", home="thermogear.study.warm_up:warm_up_survey"):
    """Follow CASE through its duty from a cold start: when is the backlash least?

    Temperatures of gears, shafts, housing and oil, half backlash and margin to the jam, flash, film
    and stiffness over time; what a thermocouple, a ring on the shaft and an infrared camera
    ([sensors]) would show. Temperatures that CASE gives are not used; nodes that
    [gearbox.measured] holds are. Writes warmup.nc, warmup.html, pictures and CSV to DIR.
    """

    duty: str | None = option(
        None,
        "--duty",
        "CSV table of the duty: time [min],speed [rpm],torque [N m],ambient [degC]; each row "
        "holds until the next, the last says the end.",
        read=_file,
        metavar="FILE",
    )
    at: Sequence[float] | None = option(
        None,
        "--at",
        "Operating point that is held until steady, without a table; the case's of the greatest "
        "power if left out.",
        read=partial(numbers, allowed="RPM,NM", fix="2000,150", count=2),
        metavar="RPM,NM",
    )
    start: float | None = option(
        None,
        "--start",
        "Temperature of everything at the start; the ambient's if left out.",
        type=float,
        read=_kelvin,
        bounds="BODY",
        metavar="DEGC",
    )
    measured: str | None = option(
        None,
        "--measured",
        "CSV record to draw over the curves: time [min],pinion_tooth [degC],oil [degC],...; "
        "columns named by nodes or sensors.",
        read=_file,
        metavar="FILE",
    )

    def arguments(self, subject: Any) -> dict[str, Any]:
        """Duty and record, read from their files."""
        from thermogear.case.duty import point_duty, read_duty, read_measured

        if self.duty is not None and self.at is not None:
            raise InputError("at", "an operating point beside --duty", fix="leave one out")
        duty = None if self.duty is None else read_duty(self.duty, subject)
        if self.at is not None:
            speed, torque = self.at
            duty = point_duty(subject, speed * RPM, torque, "at")
        record = None if self.measured is None else read_measured(self.measured)
        return {"duty": duty, "start": self.start, "measured": record}


@dataclass(frozen=True, kw_only=True)
class ReliefSurvey(Study, kind="relief", sound=True, home="thermogear.study.relief:relief_survey"):
    """Find the tip relief that makes CASE's hot pair run most evenly under load.

    Of a class: the least mean error within the mesh periods over 16 parts of the series, judged by
    64 others, beside the relief designed on perfect flanks, all rounded to what can be ground. Of
    one part: least peak-to-peak static transmission error, drawn against the unrelieved pair.
    Prints the lines for the case file. Writes relief.nc, relief.html, pictures and CSV to DIR.
    """

    torque: float | Sequence[float] | None = option(
        None,
        "--torque",
        "Pinion torque; once for each load that counts; the case's greatest if left out.",
        multiple=True,
        read=_torques,
        bounds="TORQUE",
        metavar="NM",
    )
    gear_temperature: float | Sequence[float] | None = option(
        None,
        "--temperature",
        "Addendum temperature of both gears, once for each that counts, the rest as "
        "temperatures.follow says; the case's hot state if left out.",
        type=float,
        multiple=True,
        read=_kelvins,
        bounds="BODY",
        metavar="DEGC",
    )
    shape: str = option(
        "linear", "--shape", "Form of the relief.", allowed=("linear", "parabolic")
    )  # fmt: skip
    symmetric: bool = option(
        False, "--symmetric", "The same amount and length on both gears."
    )  # fmt: skip
    largest: float | None = option(
        None,
        "--largest",
        "Greatest amount to be tried.",
        type=float,
        read=lambda _, um: um * 1e-6,
        bounds="RELIEF_AMOUNT",
        metavar="UM",
    )


@dataclass(frozen=True, kw_only=True)
class Contact(Study, kind="contact", home="thermogear.study.contact:loaded_survey"):
    """Loaded tooth contact of CASE over mesh position, load and temperature.

    Tangent and secant stiffness, transmission error, load shares, pressure, double contact (and
    how gears of unequal temperature lose it at light load), the effective contact ratio, which tip
    corner carries how much of the load, how long and from which torque on (edge contact, where no
    pressure is given), and ISO 6336-1. Writes contact.nc, contact.html, pictures and CSV to DIR.
    """

    torques: Sequence[float] = option(
        (),
        "--torques",
        "Pinion torques, or FROM:TO:COUNT; parts of the case's greatest if left out.",
        read=_axis,
        bounds="TORQUE",
        metavar="NM[,NM...]",
    )
    body: str | None = option(
        None,
        "--body",
        "Reading of the hub: held at the bore (statics), or without its wind-up [the case's].",
        allowed=("bore-clamped", "rim"),
    )


@dataclass(frozen=True, kw_only=True)
class Sensitivity(
    Study,
    kind="sensitivity",
    mean_tooth="unless stated",
    sound=True,
    home="thermogear.study.sensitivity:sensitivity_around",
    stores="Store the study and its page in DIR.",
):
    """Which inputs decide which results (extra [sensitivity]).

    Widths, loads, oil, finish, backlash, damping, error and heat run through ranges around those of
    CASE. Of the ready-made `rig` they are the inputs that the thesis leaves unstated, and its
    conclusions are judged.
    """

    samples: int = option(
        128, "--samples", "Base samples, a power of two, 8 or more; 128 for figures."
    )
    speed: float | None = option(
        None,
        "--speed",
        "Pinion speed; the case's middle one.",
        type=float,
        read=lambda _, rpm: rpm * RPM,
        bounds="SPEED",
        metavar="RPM",
    )
    seed: int = option(1, "--seed", "Seed of sampling and bootstrap.")


# --- shafts -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Statics(
    Study, kind="statics", mean_tooth="always", home="thermogear.study.shafts.statics:statics"
):
    """Loads of CASE's shafts and bearings at rest under torque, cold and hot.

    Bearing loads and clearances, deflection of the shafts, the actual centre distance with its
    contact ratio and backlash, and the tilt of the gears. CASE needs [[shafts]] and [[bearings]].
    """


COUNT = range(1, 61)
"""Modes that a study of the drive train may list (ours)."""


@dataclass(frozen=True, kw_only=True)
class NaturalModes(
    Study, kind="modes", mean_tooth="always", home="thermogear.study.shafts.modes:modes"
):
    """Natural frequencies of CASE's drive train, and which part bends in each mode.

    Cold and hot, with the bearings' stiffness under load and the mesh at its mean.
    """

    operating: int | None = option(
        None, "--operating", "Operating point; the hardest if left out.", type=int, metavar="N"
    )
    count: int = option(12, "--count", "Number of modes.", allowed=COUNT)


@dataclass(frozen=True, kw_only=True)
class Campbell(
    Study, kind="campbell", mean_tooth="always", home="thermogear.study.shafts.campbell:campbell"
):
    """Critical speeds of CASE's drive train, cold and hot, and what vibrates there.

    Natural frequencies over speed with the band of the mesh stiffness; orders of mesh, shafts and
    bearings; the response of every bearing to transmission error and unbalance.
    """

    speeds: tuple[float, float] | None = option(
        None,
        "--rpm",
        "Pinion speeds; 0 to 1.5 times the case's greatest.",
        read=_range,
        bounds="SPEED",
        metavar="LOW:HIGH",
    )
    torque: float | None = option(
        None,
        "--torque",
        "Pinion torque; the hardest point's.",
        type=float,
        bounds="TORQUE",
        metavar="NM",
    )
    count: int = option(12, "--count", "Number of modes.", allowed=COUNT)


# --- one motion -------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class ClosedOrbit(Study, kind="orbit", home="thermogear.study.orbit:orbit_results", of="point"):
    """The closed orbit a motion settles on, with its Floquet multipliers.

    Of a case with [[shafts]] too it is the gear pair's on rigid bearings; what its drive train
    settles on is shown by run, its orbits are followed by continue.

    \b
      thermogear orbit table-4.2 --row zeta --point 2
      thermogear orbit --zeta 0.1535 --w 1.245 --eps 0.335 --fm 0.017 --fh -1.16 --period 2
    """

    period: int | None = option(
        None, "--period", "Mesh periods of the orbit [what the motion settles on].", type=int
    )
    transient: bool = option(
        True,
        "--direct",
        "Newton from the start itself, which reaches unstable orbits.",
        read=lambda _, direct: not direct,
    )


@dataclass(frozen=True, kw_only=True)
class Lyapunov(
    Study,
    kind="lyapunov",
    home="thermogear.study.orbit:lyapunov_results",
    of="point",
):
    """The largest Lyapunov exponent of a motion with its error.

    \b
      thermogear lyapunov table-4.2 --row zeta --point 4
    """

    discard: int = option(2000, "--discard", "Periods thrown away.")
    batches: int = option(40, "--batches", "Batches of the mean.", allowed=range(4, 100_001))
    batch_periods: int = option(500, "--batch-periods", "Periods in each.")


COMMANDS: dict[str, type[Study]] = {
    study.kind: study
    for study in (
        Answers, Friction, Temperature, WarmUpSurvey, ReliefSurvey, Contact, Sensitivity,
        Statics, NaturalModes, Campbell, ClosedOrbit, Lyapunov,
    )
}  # fmt: skip
"""Every declared study by the name of its command."""
