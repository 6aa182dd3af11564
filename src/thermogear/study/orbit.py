"""Orbits, Lyapunov exponents and branches of one point of a case, as trees of labelled results.

Each function returns a :class:`~thermogear.results.result.Result` with a summary. Numbers are
dimensionless (X = x/b_c, omega_n t) unless a name says SI; where a gear stands behind them the
tree carries metres, seconds and hertz.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from thermogear.analysis.labels import label
from thermogear.analysis.lyapunov import lyapunov_exponents
from thermogear.analysis.orbits import Orbit, periodic_orbit
from thermogear.analysis.proof import Label
from thermogear.base.arrays import Dataset
from thermogear.base.errors import ConvergenceError
from thermogear.base.notice import Notice
from thermogear.base.period import Period
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label as labelled
from thermogear.base.vocabulary import label_words
from thermogear.case.one_point import OnePoint
from thermogear.dynamics.integrate import simulate
from thermogear.results.result import Result
from thermogear.signals.spectra import amplitude_spectrum
from thermogear.study.declared import ClosedOrbit, Lyapunov, declared

SAMPLES = 256
"""Samples a mesh period of a stored orbit."""
MOST_SAMPLES, LEAST_SAMPLES = 100_000, 64
"""Samples of a whole orbit over many mesh periods, and of each of them all the same."""
HIGHEST_ORDER = 20.0
LEAST_LINE = 1e-12
"""Lines below this part of the greatest are rounding."""
ROUNDING = 1e-9
LINES_OF_TURN = 200
"""Lines told of an orbit over a turn, the greatest; all are stored."""
ROUNDS = 10


def found(
    kind: str,
    groups: dict[str, Dataset],
    summary: dict[str, Any],
    notices: Iterable[Notice] = (),
    *,
    interrupted: bool = False,
) -> Result:
    """The result of one motion: its summary beside the groups."""
    return Result.of(
        kind,
        str(summary["title"]),
        groups,
        notices,
        summary=summary,
        interrupted=interrupted,
    )


# --- orbits -------------------------------------------------------------------------------


def settled(point: OnePoint, model: object | None = None) -> Label:
    """What the motion of ``point`` settles on from its start, with proof."""
    simulation = point.simulation
    return label(
        point.points if model is None else model,
        initial_state=simulation.initial_state,
        discard=max(simulation.discard, 1),
        cap=max(simulation.most_discarded, 32_000),
    )


def orbit_of(
    point: OnePoint,
    period: int | None = None,
    *,
    transient: bool = True,
    model: object | None = None,
) -> tuple[Orbit, Label | None]:
    """The closed orbit a motion settles on, or the one of ``period`` near where it ends.

    An orbit that closes earlier already comes back with its least period. Without ``transient``
    Newton starts from the given state itself, which reaches unstable
    orbits. Raises ConvergenceError where no orbit is reached.
    """
    model = point.points if model is None else model
    start = point.simulation.initial_state
    if not transient:
        return _least(periodic_orbit(model, 1 if period is None else period, start)), None
    proof = settled(point, model)
    if proof.orbit is not None and period in (None, proof.orbit.period):
        return proof.orbit, proof
    if period is None:
        raise ConvergenceError(
            f"no closed orbit: the motion from {list(start)} is {proof} ({proof.reason}); "
            "give a period to look for an orbit inside it"
        )
    end = simulate(
        model,
        periods=1,
        discard=point.simulation.discard,
        samples_per_period=0,
        initial_state=start,
        method="exact",
    )
    guess = [float(end["section_x"][0, -1]), float(end["section_v"][0, -1])]
    return _least(periodic_orbit(model, period, guess)), proof


def _least(orbit: Orbit) -> Orbit:
    """The same motion, closed after its least period."""
    if orbit.minimal_period == orbit.period:
        return orbit
    return periodic_orbit(orbit.model, orbit.minimal_period, orbit.state)


def complex_rows(values: Any, error: float = 0.0) -> list[dict[str, float]]:
    """Multipliers as plain numbers, each with its ``error`` where there is one."""
    known = {"error": error} if error > 0.0 else {}
    return [
        {"real": float(mu.real), "imag": float(mu.imag), "modulus": float(abs(mu))} | known
        for mu in values
    ]


@declared(ClosedOrbit)
def orbit_results(
    point: OnePoint,
    period: int | None = None,
    *,
    transient: bool = True,
    progress: Progress = silent,
) -> Result:
    """State, multipliers, contact changes, load factor and spectrum of one closed orbit."""
    progress("orbit", 0, 2)
    orbit, proof = orbit_of(point, period, transient=transient)
    progress("orbit", 1, 2)
    result = told_orbit(point, orbit, proof, period)
    progress("orbit", 2, 2)
    return result


def told_orbit(
    point: OnePoint, orbit: Orbit, proof: Label | None, period: int | None = None
) -> Result:
    """The result of a closed ``orbit`` that is known; ``period``: of how many one has asked."""
    points, b = point.points, float(orbit.lanes.half_backlash[0])
    length, rate = float(points.length[0]), float(points.rate[0])
    hertz = float(points.mesh_frequency[0] / (2.0 * np.pi))
    of = orbit.lanes.mesh_periods
    samples = max(LEAST_SAMPLES, min(SAMPLES, MOST_SAMPLES // of))
    phase, x, v = orbit.samples(samples)
    spectrum = amplitude_spectrum(x, float(orbit.sampling(samples)))
    kept = spectrum.frequencies <= HIGHEST_ORDER
    order = spectrum.frequencies[kept]
    amplitude = spectrum.amplitudes[kept]
    low, high = orbit.extremes()
    shares = orbit.time_share
    factor = orbit.dynamic_load_factor()
    mu = orbit.multipliers
    period_time = float(orbit.lanes.mesh_period[0]) / rate
    speed = length * rate
    variables: dict[str, Any] = {
        "time": (("sample",), phase * period_time),
        "displacement": (("sample",), x * length),
        "velocity": (("sample",), v * speed),
        "section_displacement": (("section",), orbit.points[:, 0] * length),
        "section_velocity": (("section",), orbit.points[:, 1] * speed),
        "order": (("order",), order),
        "line_amplitude": (("order",), amplitude * length),
        "multiplier_real": (("multiplier",), mu.real),
        "multiplier_imag": (("multiplier",), mu.imag),
        "orbit_period": ((), orbit.period),
        "contact_losses": ((), orbit.contact_losses),
        "back_impacts_per_orbit": ((), orbit.back_impacts),
        "drive_share": ((), shares["drive"]),
        "free_share": ((), shares["free"]),
        "back_share": ((), shares["back"]),
        "dynamic_load_factor": ((), factor),
        "half_backlash": ((), b * length),
        "least_displacement": ((), low * length),
        "greatest_displacement": ((), high * length),
    }
    if points.gears:
        variables["line_frequency"] = (("order",), order * hertz)
    data = labelled(variables)
    if of > 1:
        data.attrs["mesh_periods"] = of
        if points.gears:
            data.attrs["teeth"] = point.gears.period.teeth
    data["phase"] = (("sample",), phase, {"units": "1", "long_name": "time in mesh periods"})
    if not points.gears:
        _without_units(data)
    greatest = np.sort(amplitude[1:])[-LINES_OF_TURN if of > 1 else 0 :]
    least = max(
        LEAST_LINE * max(float(greatest[-1]), 1e-300), (1.0 - 1e-12) * float(greatest[0]) * (of > 1)
    )
    shown = (order > 0.0) & (amplitude > least)
    whole, repeats = order * of, point.gears.period if points.gears else Period(of)
    lines = [
        {
            "order": float(q),
            "name": repeats.line(round(n)) if abs(n - round(n)) < ROUNDING * of else None,
            "amplitude": float(a * length),
            "frequency_hz": float(q * hertz) if points.gears else None,
            "half_order": bool(
                abs(2.0 * n - round(2.0 * n)) < ROUNDING * of and round(2.0 * n) % 2 == 1
            ),
        }
        for q, n, a in zip(order[shown], whole[shown], amplitude[shown], strict=True)
    ]
    summary: dict[str, Any] = {
        "title": point.title,
        "parameters": point.parameters,
        "units": "SI" if points.gears else "dimensionless",
        "label": label_words(
            f"period-{orbit.minimal_period}", followed=0, starts=1, mesh_periods=of
        ),
        "settles_there": None if proof is None else str(proof),
        "reason": None if proof is None else proof.reason,
        "period": orbit.period,
        **({"mesh_periods": of} if of > 1 else {}),
        "state": [float(c) for c in orbit.state],
        "points": [[float(c) for c in p] for p in orbit.points],
        "state_si": [float(orbit.state[0] * length), float(orbit.state[1] * speed)]
        if points.gears
        else None,
        "multipliers": complex_rows(mu),
        "determinant": orbit.determinant,
        "stable": orbit.stable,
        "contact_losses": orbit.contact_losses,
        "back_impacts": orbit.back_impacts,
        "time_share": shares,
        "dynamic_load_factor": factor if np.isfinite(factor) else None,
        "least": low * length,
        "greatest": high * length,
        "half_backlash": b * length,
        "mesh_frequency_hz": hertz if points.gears else None,
        "residual": orbit.residual,
        "lines": lines,
    }
    notices = _orbit_notices(orbit, low, b, period)
    return found(ClosedOrbit.kind, {"orbit": data}, summary, notices)


def _without_units(data: Dataset) -> None:
    """Dimensionless numbers carry no metres."""
    for name in data.variables:
        unit = data[name].attrs.get("units")
        if unit is not None:
            data[name].attrs["units"] = "1"


def _orbit_notices(orbit: Orbit, low: float, b: float, asked: int | None) -> Iterator[Notice]:
    least = orbit.minimal_period
    wanted = orbit.period if asked is None else asked
    if not wanted == orbit.period == least:
        yield Notice.of("other_period", asked=wanted, period=least)
    if low > b:
        yield Notice.of("motion_linear")
    elif low > -b and orbit.lanes.mesh_periods == 1:  # b' of a turn is its mean
        # y = x - b' stays; the back flank stands at y = -2 b'
        yield Notice.of("back_flank_not_reached", down_to=max(0.5 * (b - low), 0.0))
    if not orbit.stable:
        yield Notice.of("orbit_unstable")


# --- Lyapunov exponents -------------------------------------------------------------------


@declared(Lyapunov)
def lyapunov_results(
    point: OnePoint,
    *,
    discard: int = Lyapunov.discard,
    batches: int = Lyapunov.batches,
    batch_periods: int = Lyapunov.batch_periods,
    progress: Progress = silent,
) -> Result:
    """lambda_1 with the error of its batch means, in rounds, so that Ctrl+C keeps what is done."""
    rounds = min(ROUNDS, batches // 2)
    sizes = [batches // rounds + (1 if i < batches % rounds else 0) for i in range(rounds)]
    state = np.asarray(point.simulation.initial_state, dtype=float)
    means: list[float] = []
    total, damping = 0.0, 0.0
    cut = False
    try:
        for number, size in enumerate(sizes):
            progress("batches", number, rounds)
            (one,) = lyapunov_exponents(
                point.points,
                initial_state=state,
                discard=discard if number == 0 else 0,
                batches=size,
                batch_periods=batch_periods,
            )
            state, total, damping = one.state, one.sum, -one.sum
            means += one.batches.tolist()
        progress("batches", rounds, rounds)
    except KeyboardInterrupt:
        if len(means) < 2:
            raise
        cut = True
    values = np.array(means)
    if not np.all(np.isfinite(values)):
        raise ConvergenceError("lyapunov: the motion diverges (|x| > 1e6 half backlashes)")
    value = float(values.mean())
    error = float(values.std(ddof=1) / np.sqrt(values.size))
    rate, period = float(point.points.rate[0]), float(point.points.flat.mesh_period[0])
    dimension = 1.0 + value / abs(total - value) if value > 0.0 else 0.0
    half = values.size // 2
    ran = discard + values.size * batch_periods
    chaos = label_words("chaotic", followed=ran, starts=1)
    sure = value > 4.0 * error and values[:half].mean() > 0.0 and values[half:].mean() > 0.0
    calm = value < -4.0 * error
    verdict = chaos if sure else "not chaotic" if calm else "undecided"
    notices = []
    # a positive mean says nothing of how long chaos lasts
    end = label(point.points, initial_state=state, discard=128, cap=512, starts=2, follow=1)
    if end.orbit is not None and not calm:
        verdict = f"not chaotic at its end: {end.words.replace('-', ' ')} after {ran} periods"
        notices.append(Notice.of("exponent_of_transient"))
    data = labelled(
        {
            "lyapunov_batch": (("batch",), values),
            "lyapunov_exponent": ((), value),
            "lyapunov_error": ((), error),
        }
    )
    summary: dict[str, Any] = {
        "title": point.title,
        "parameters": point.parameters,
        "exponent": value,
        "error": error,
        "sum": total,
        "sum_is": "-2 zeta, exactly",
        "damping": damping,
        "second": total - value,
        "kaplan_yorke": dimension,
        "per_mesh_period": value * period,
        "per_second": value * rate if point.points.gears else None,
        "batches": int(values.size),
        "batch_periods": batch_periods,
        "discarded": discard,
        "verdict": verdict,
        "state": [float(c) for c in state],
        "interrupted": cut,
    }
    return found(Lyapunov.kind, {"lyapunov": data}, summary, notices, interrupted=cut)
