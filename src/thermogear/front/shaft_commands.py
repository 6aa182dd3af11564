"""``statics``, ``modes`` and ``campbell``: a gear pair on its shafts and bearings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.results.result import Result


@click.command()
@delivery.case
@delivery.output()
@delivery.overrides
@delivery.csv
@delivery.as_json
def statics(case: str, output: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Loads of CASE's shafts and bearings at rest under torque, cold and hot.

    Bearing loads and clearances, deflection of the shafts, the actual centre distance with its
    contact ratio and backlash, and the tilt of the gears. CASE needs [[shafts]] and [[bearings]].
    """
    read = delivery.load_gears(case, overrides)

    def make(report: Progress) -> Result:
        from thermogear.study.shafts.statics import statics as study

        return study(read, progress=report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@delivery.case
@delivery.output()
@delivery.overrides
@click.option(
    "--operating", type=int, metavar="N", help="Operating point; the hardest if left out."
)
@click.option("--count", type=int, default=12, show_default=True, help="Number of modes.")
@delivery.csv
@delivery.as_json
def modes(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    operating: int | None,
    count: int,
    as_json: bool,
) -> None:
    """Natural frequencies of CASE's drive train, and which part bends in each mode.

    Cold and hot, with the bearings' stiffness under load and the mesh at its mean.
    """
    read = delivery.load_gears(case, overrides)

    def make(report: Progress) -> Result:
        from thermogear.study.shafts.modes import modes as study

        return study(read, operating=operating, count=count, progress=report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@delivery.case
@delivery.output()
@delivery.overrides
@click.option(
    "--rpm", metavar="LOW:HIGH", help="Pinion speeds; 0 to 1.5 times the case's greatest."
)
@click.option("--torque", type=float, metavar="NM", help="Pinion torque; the hardest point's.")
@click.option("--count", type=int, default=12, show_default=True, help="Number of modes.")
@delivery.csv
@delivery.as_json
def campbell(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    rpm: str | None,
    torque: float | None,
    count: int,
    as_json: bool,
) -> None:
    """Critical speeds of CASE's drive train, cold and hot, and what vibrates there.

    Natural frequencies over speed with the band of the mesh stiffness; orders of mesh, shafts and
    bearings; the response of every bearing to transmission error and unbalance.
    """
    read = delivery.load_gears(case, overrides)
    speeds = None if rpm is None else _range(rpm)

    def make(report: Progress) -> Result:
        from thermogear.study.shafts.campbell import campbell as study

        return study(read, speeds=speeds, torque=torque, count=count, progress=report)

    delivery.deliver(make, output, as_json=as_json)


def _range(text: str) -> tuple[float, float]:
    """LOW:HIGH rpm as [rad/s]."""
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise InputError(
            "--rpm", repr(text), allowed="LOW:HIGH", fix="write --rpm 0:6000"
        ) from None
    return low * RPM, high * RPM


COMMANDS = (statics, modes, campbell)
