"""Drive trains that lose contact: our engine beside others, on the same four settled motions.

Prints a table: for every solver mesh periods per second of processor time (one thread, median of
interleaved rounds), and the worst error of delta_d over 20 mesh periods over its size, against
DOP853 restarted at every contact change at 1e-12. `--quick`: one round of the two small trains.
`--closure`: do the public sections N1, N2 and N3 come back to themselves?
"""

from __future__ import annotations

import argparse
import contextlib
import os
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402
from geared_compiled import Modal, run_alpha, run_rk4  # noqa: E402
from geared_heyoka import Taylor  # noqa: E402
from geared_ross import newmark  # noqa: E402
from geared_trains import TRUTH, Plain, equilibrium, state_of, train_of  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from drive_reference import Reference, closing  # noqa: E402  # isort: skip

Floats = NDArray[np.float64]
Run = Callable[[], Floats]

PERIODS, KEPT, ROUNDS, LEAST = 20, 16, 5, 0.1
"""Periods of a run, phases of each at which delta_d is kept, rounds, seconds of a timing."""


class Missing(Exception):
    """A rival that cannot be used here, and why."""


@dataclass(frozen=True)
class Motion:
    """A motion with contact loss: what differs from the truth's train, and how long it settles.

    ``error`` [m]: first harmonic of e is error (1 - i/2); ``torque`` [N m], ``rpm`` of the pinion,
    ``settle`` mesh periods from the equilibrium at mean stiffness, Runge-Kutta of 256 steps.
    """

    size: int
    what: str
    error: float
    torque: float
    rpm: float
    settle: int

    def train(self) -> Plain:
        """The arrays."""
        case = TRUTH["N1" if self.size == 6 else "N3"]["params"]
        own = {"e_re": [self.error], "e_im": [-0.5 * self.error]}
        return train_of(self.size, case | own | {"T1": self.torque, "rpm": self.rpm})


MOTIONS = (
    Motion(6, "lumped, two rings", 1.47e-5, 22.0, 7510.0, 3000),
    Motion(12, "rig, mesh only", 1.1e-5, 24.0, 7340.0, 8000),
    Motion(30, "rig, four rings", 6.8e-6, 38.0, 7680.0, 4000),
    Motion(60, "rig, four rings", 6.8e-6, 38.0, 7680.0, 2000),
)
"""Taken from a draw by numpy's default_rng (seeds 206, 212, 130) of errors from 4 to 25 um, torques
from 10 to 80 N m and speeds from 2000 to 8000 rpm, before any solver was timed: flanks part, with 2
to 3.3 contact changes a period, and the motion settles to a periodic one (the bench prints how far
it has); 6 has a bearing that lifts as well; 60 is the point of 30."""


# --- the rivals: what runs once, and gives delta_d at KEPT phases of each period ----------------


def reference(p: Plain, start: Floats) -> tuple[Run, Run]:
    def track() -> Floats:
        times = np.arange(PERIODS * KEPT) / (KEPT * p.mesh_frequency)
        return Reference(p).states(start, times)[:, : p.drive.size] @ p.drive

    def run() -> Floats:
        return Reference(p).after(start, PERIODS)

    return run, track


def fixed(scheme: Any, steps: int) -> Any:
    def make(p: Plain, start: Floats) -> tuple[Run, Run]:
        modal = Modal.of(p)
        z = modal.state(start)

        def run() -> Floats:
            return scheme(modal, z, PERIODS, steps, KEPT)[1]

        return run, run

    return make


def heyoka(tolerance: float) -> Any:
    def make(p: Plain, start: Floats) -> tuple[Run, Run]:
        try:
            modal = Modal.of(p)
            own = Taylor(modal, tolerance)
        except ImportError as error:
            raise Missing(str(error)) from error
        z = modal.state(start)
        return lambda: own.run(z, PERIODS), lambda: own.track(z, PERIODS, KEPT)

    return make


def ross(steps: int) -> Any:
    def make(p: Plain, start: Floats) -> tuple[Run, Run]:
        modal = Modal.of(p)
        z = modal.state(start)

        def run() -> Floats:
            return newmark(modal, z, PERIODS, steps, 1e-6)[:: steps // KEPT]

        try:
            with quiet():
                newmark(modal, z, 1, KEPT, 1e-6)
        except ImportError as error:
            raise Missing(str(error)) from error
        return run, run

    return make


def numbalsoda(p: Plain, start: Floats) -> tuple[Run, Run]:
    try:
        version("numbalsoda")
    except PackageNotFoundError as error:
        raise Missing("not installable here: no Fortran compiler, no wheel") from error
    raise Missing("installed, but its right side is not written here")


def ours(accuracy: float, **how: int) -> Any:
    """Our engine: the only place that knows how it is called."""

    def make(p: Plain, start: Floats) -> tuple[Run, Run]:
        try:
            from thermogear.dynamics.geared import GearedModel, LocalBearing
            from thermogear.dynamics.ladder import Engine, Steps
        except ImportError as error:
            raise Missing(str(error)) from error
        rest = equilibrium(p)[: p.drive.size]
        bearings = []
        for one in p.bearings:
            u = one.directions.T @ rest
            r = float(np.hypot(*u))
            own = {"coefficient": one.coefficient, "exponent": one.exponent}
            base = one.coefficient * np.outer(u, u) / r**2
            base = base + one.coefficient * max(1.0 - one.clearance / r, 0.0) * (
                np.eye(2) - np.outer(u, u) / r**2
            )
            bearings.append(
                LocalBearing(directions=one.directions, clearance=one.clearance, base=base, **own)
            )
        names = ("mass", "damping", "stiffness", "force", "drive", "back", "mesh_stiffness")
        names += ("error", "half_backlash", "mesh_damping", "mesh_frequency")
        given = {name: getattr(p, name) for name in names}
        engine = Engine(
            GearedModel(**given, bearings=tuple(bearings)), Steps(accuracy=accuracy, **how)
        )

        def track() -> Floats:
            return engine.run(start, PERIODS, samples=KEPT).samples[:, : p.drive.size] @ p.drive

        return lambda: engine.run(start, PERIODS).state, track

    return make


RIVALS: tuple[tuple[str, Any], ...] = (
    ("thermogear, accuracy 1e-6", ours(1e-6)),
    ("thermogear, accuracy 1e-7", ours(1e-7)),
    ("thermogear, accuracy 1e-9", ours(1e-9)),
    ("thermogear, accuracy 1e-12", ours(1e-12)),
    ("heyoka, terminal events, 1e-9", heyoka(1e-9)),
    ("heyoka, terminal events, 1e-12", heyoka(1e-12)),
    ("Runge-Kutta 4, numba, 256 steps", fixed(run_rk4, 256)),
    ("Runge-Kutta 4, numba, 1024 steps", fixed(run_rk4, 1024)),
    ("generalised-alpha, numba, 1024 steps", fixed(run_alpha, 1024)),
    ("ROSS 2.3 Newmark, callback, 1024 steps", ross(1024)),
    ("numbalsoda", numbalsoda),
    ("scipy DOP853 restarted at changes, 1e-12", reference),
)


# --- measuring ----------------------------------------------------------------------------------


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """What libraries print when they are imported is no part of the table, C's output as well."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
        sys.stdout.flush()
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def settled(motion: Motion, p: Plain) -> tuple[Floats, Floats]:
    """(q, q') of the settled motion, and contact changes a period of every contact."""
    modal = Modal.of(p)
    z = modal.state(equilibrium(p))
    z = run_rk4(modal, z, motion.settle, 256, KEPT)[0]
    start = modal.back(z)
    own = Reference(p)
    own.after(start, PERIODS)
    counts = np.bincount([which for _, which in own.changes], minlength=2 + len(p.bearings))
    return start, counts / PERIODS


def seconds(run: Run) -> float:
    """Processor time of one run, of as many as take :data:`LEAST`."""
    begun, count = time.process_time(), 0
    while True:
        run()
        count += 1
        spent = time.process_time() - begun
        if spent >= LEAST:
            return spent / count


@dataclass
class Found:
    """One solver on one motion: rates of the rounds, error; or why it is missing."""

    rates: list[float]
    error: float = float("nan")
    missing: str = ""

    def cell(self) -> str:
        """As it stands in the table."""
        if self.missing:
            return "–"
        rate = statistics.median(self.rates)
        size = "reference" if self.error == 0.0 else f"{self.error:.0e}"
        return f"{rate:,.0f} ({1e3 * PERIODS / rate:,.2f} ms; {size})"


def measured(motion: Motion, rounds: int, said: Callable[[str], None]) -> dict[str, Found]:
    """Every rival on one motion."""
    p = motion.train()
    start, changes = settled(motion, p)
    total = changes.sum()
    found: dict[str, Found] = {}
    runs: dict[str, Run] = {}
    _, exact = reference(p, start)
    known = exact()
    size = np.abs(known).max()
    rows = known.reshape(PERIODS, KEPT)
    away = {k: np.abs(rows[k:] - rows[:-k]).max() / size for k in range(1, 5)}
    cycle = min(away, key=lambda k: away[k])
    said(
        f"{motion.size}: {motion.error:.3g} m, {motion.torque:g} N m, {motion.rpm:g} rpm; "
        f"{total:.2f} contact changes a period, of each contact {changes.tolist()}; after {cycle} "
        f"periods the same within {away[cycle]:.0e}"
    )
    for name, make in RIVALS:
        try:
            with quiet():
                run, track = make(p, start)
                delta = track()
                run()
        except Missing as error:
            found[name] = Found([], missing=str(error))
            continue
        found[name] = Found([], float(np.abs(delta - known).max() / size))
        runs[name] = run
    for _ in range(rounds):
        for name, run in runs.items():
            found[name].rates.append(PERIODS / seconds(run))
    return found


def closure() -> None:
    """Worst differences of the public sections after their periods, m and m/s."""
    print("Sections of the public truth after their periods, by restarted DOP853:")
    for name in ("N1", "N2", "N3"):
        case = TRUTH[name]
        values, own = case["values"], case["params"]
        p = train_of(6 if own["system"] == "six" else 30, own)
        rows = np.vstack([p.drive, p.back, *(b.directions.T for b in p.bearings)])
        n = p.drive.size
        section = values["section"]
        if own["system"] == "six":
            x = state_of(p, section)
        else:
            # the section gives ten outputs of thirty coordinates: the motion is found anew
            x = closing(p, Reference(p).after(equilibrium(p), 3), values["periods"])
            away = [np.abs(rows @ part - section[k]).max() for part, k in
                    ((x[:n], "y"), (x[n:], "ydot"))]  # fmt: skip
            print(f"  {name}: its section {away[0]:.1e} m, {away[1]:.1e} m/s from the truth's")
        reference = Reference(p)
        end = reference.after(x, values["periods"]) - x
        print(
            f"  {name}: {np.abs(rows @ end[:n]).max():.1e} m, {np.abs(rows @ end[n:]).max():.1e}"
            f" m/s, {len(reference.changes)} contact changes ({values['dop853_events']})"
        )


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--closure", action="store_true")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    if arguments.closure:
        closure()
        return 0
    motions = MOTIONS[:2] if arguments.quick else MOTIONS
    rounds = 1 if arguments.quick else arguments.rounds
    lines: list[str] = []
    every = []
    for motion in motions:
        print(f"{time.strftime('%H:%M:%S')} {motion.size}", file=sys.stderr, flush=True)
        every.append(measured(motion, rounds, lines.append))
    print(f"Mesh periods/s of processor time, median of {rounds} interleaved rounds of {PERIODS}")
    print("periods; in brackets processor time of one run and the worst error of delta_d over its")
    print("size.\n")
    print("| solver |" + "".join(f" {m.size} ({m.what}) |" for m in motions))
    print("|---|" + "---|" * len(motions))
    for name, _ in RIVALS:
        print(f"| {name} |" + "".join(f" {one[name].cell()} |" for one in every))
    print()
    for name, _ in RIVALS:
        reasons = {one[name].missing for one in every} - {""}
        for reason in sorted(reasons):
            print(f"{name}: {reason}")
    print("\n".join(lines))
    packages = ("heyoka", "numba", "numpy", "scipy", "ross-rotordynamics")
    print(", ".join(f"{one} {version(one)}" for one in packages))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
