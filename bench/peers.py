"""Every solver on the same work: end states after a number of periods, and its rate."""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np
from points import Points

STEPS = 256
MOST_STEPS = 2**31 - 1
"""For a solver that stops after a number of steps, numbalsoda after 10 000: no stop."""
Run = Callable[[Points, int], np.ndarray]


@dataclass(frozen=True)
class Peer:
    """A solver: ``run(points, periods)`` gives end states (point, 2); sizes of a timed round."""

    name: str
    run: Run
    points: int
    periods: int
    note: str = ""


class Missing(Exception):
    """A peer that cannot be used here, and why."""


# --- scipy --------------------------------------------------------------------------------


def _scipy(method: str, rtol: float) -> Run:
    from scipy.integrate import solve_ivp

    def run(points: Points, periods: int) -> np.ndarray:
        out = np.empty((len(points), 2))
        for i in range(len(points)):
            zeta, w, eps, mean, force = (
                float(a[i]) for a in (points.zeta, points.w, points.eps, points.mean, points.force)
            )

            def rate(t, y, zeta=zeta, w=w, eps=eps, mean=mean, force=force):
                x = y[0]
                f = x - min(max(x, -1.0), 1.0)
                c = np.cos(w * t)
                return (y[1], mean + force * c - 2 * zeta * y[1] - (1 + eps * c) * f)

            end = 2 * np.pi / w * periods
            found = solve_ivp(rate, (0, end), points.start[i], method=method, rtol=rtol, atol=1e-12)
            out[i] = found.y[:, -1]
        return out

    return run


# --- a numba loop as users write it ---------------------------------------------------------


@numba.njit
def _rate(t, x, v, zeta, w, eps, mean, force):
    f = 0.0
    if x > 1.0:
        f = x - 1.0
    elif x < -1.0:
        f = x + 1.0
    c = np.cos(w * t)
    return mean + force * c - 2 * zeta * v - (1 + eps * c) * f


@numba.njit
def _loop(zeta, w, eps, mean, force, start, periods, steps, out):
    for i in range(zeta.size):
        z, om, e, m, a = zeta[i], w[i], eps[i], mean[i], force[i]
        h = 2 * np.pi / om / steps
        x, v = start[i]
        for n in range(periods * steps):
            t = n * h
            k1 = _rate(t, x, v, z, om, e, m, a)
            k2 = _rate(t + h / 2, x + h / 2 * v, v + h / 2 * k1, z, om, e, m, a)
            x3 = x + h / 2 * (v + h / 2 * k1)
            k3 = _rate(t + h / 2, x3, v + h / 2 * k2, z, om, e, m, a)
            k4 = _rate(t + h, x + h * (v + h / 2 * k2), v + h * k3, z, om, e, m, a)
            x += h * v + h * h / 6 * (k1 + k2 + k3)
            v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out[i, 0] = x
        out[i, 1] = v


def numba_loop(points: Points, periods: int) -> np.ndarray:
    out = np.empty((len(points), 2))
    p = points
    _loop(p.zeta, p.w, p.eps, p.mean, p.force, p.start, periods, STEPS, out)
    return out


# --- numbalsoda -----------------------------------------------------------------------------


def _numbalsoda(method: str) -> Run:
    if importlib.util.find_spec("numbalsoda") is None:
        raise Missing("no wheel for this Python, and its build needs a Fortran compiler")
    try:
        import numbalsoda
    except (ImportError, OSError) as error:  # installed without the library it opens
        raise Missing(f"installed, but it cannot be loaded: {error}") from error

    @numba.cfunc(numbalsoda.lsoda_sig)
    def rate(t, y, dy, p):
        x = y[0]
        f = x - min(max(x, -1.0), 1.0)
        c = np.cos(p[1] * t)
        dy[0] = y[1]
        dy[1] = p[3] + p[4] * c - 2 * p[0] * y[1] - (1 + p[2] * c) * f

    solver = getattr(numbalsoda, method)
    address = rate.address

    @numba.njit
    def work(parameters, start, ends, out):
        for i in range(start.shape[0]):
            times = np.array([0.0, ends[i]])
            found, reached = solver(
                address, start[i], times, parameters[i], rtol=1e-9, atol=1e-12, mxstep=MOST_STEPS
            )
            out[i] = found[-1]
            if not reached:
                out[i] = np.nan

    def run(points: Points, periods: int) -> np.ndarray:
        p = points
        parameters = np.stack([p.zeta, p.w, p.eps, p.mean, p.force], axis=1)
        out = np.empty((len(p), 2))
        work(parameters, p.start.copy(), 2 * np.pi / p.w * periods, out)
        if np.isnan(out).any():  # a run that was cut short would count as fast
            raise RuntimeError(f"numbalsoda {method}: an end was not reached")
        return out

    return run


# --- heyoka with terminal events ------------------------------------------------------------


def heyoka_solver(tolerance: float | None = None, restarted: bool = False) -> Run:
    """Taylor integration stopped at every edge; machine precision without a tolerance.

    ``restarted`` sets the time back every period, so that its rounding does not grow: the
    difference to the plain run is the reference's own noise.
    """
    try:
        import heyoka as hy
    except ImportError as error:
        raise Missing(str(error)) from error

    x, v = hy.make_vars("x", "v")
    zeta, w, eps, mean, force, region = (hy.par[i] for i in range(6))
    c = hy.cos(w * hy.time)
    elastic = (1.0 + eps * c) * (region * region * x - region)
    equations = [(x, v), (v, mean + force * c - 2.0 * zeta * v - elastic)]

    def upper(ta, sign):
        ta.pars[5] = 1.0 if sign > 0 else 0.0
        return True

    def lower(ta, sign):
        ta.pars[5] = -1.0 if sign < 0 else 0.0
        return True

    events = [hy.t_event(x - 1.0, callback=upper), hy.t_event(x + 1.0, callback=lower)]
    options = {} if tolerance is None else {"tol": tolerance}
    ta = hy.taylor_adaptive(equations, [0.0, 0.0], t_events=events, pars=[0.0] * 6, **options)

    def run(points: Points, periods: int) -> np.ndarray:
        out = np.empty((len(points), 2))
        for i in range(len(points)):
            x0, v0 = points.start[i]
            own = (points.zeta[i], points.w[i], points.eps[i], points.mean[i], points.force[i])
            ta.pars[:] = [*own, float(x0 > 1.0) - float(x0 < -1.0)]
            ta.state[:] = x0, v0
            ta.time = 0.0
            ta.reset_cooldowns()
            period = 2.0 * np.pi / points.w[i]
            if restarted:
                for _ in range(periods):
                    ta.time = 0.0
                    ta.propagate_until(period)
            else:
                ta.propagate_until(period * periods)
            out[i] = ta.state
        return out

    return run


# --- JAX ------------------------------------------------------------------------------------


def jax_rk4() -> Run:
    try:
        import jax
    except ImportError as error:
        raise Missing(str(error)) from error
    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    def one_period(state, _, constants):
        zeta, w, eps, mean, force = constants
        h = 2 * jnp.pi / w / STEPS

        def rate(c, x, v):
            f = x - jnp.clip(x, -1.0, 1.0)
            return mean + force * c - 2 * zeta * v - (1 + eps * c) * f

        def step(carry, cosines):
            x, v = carry
            c0, c1, c2 = cosines
            a1 = rate(c0, x, v)
            a2 = rate(c1, x + h / 2 * v, v + h / 2 * a1)
            a3 = rate(c1, x + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
            a4 = rate(c2, x + h * (v + h / 2 * a2), v + h * a3)
            x = x + h * v + h * h / 6 * (a1 + a2 + a3)
            return (x, v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)), None

        table = jnp.cos(2 * jnp.pi * jnp.arange(2 * STEPS + 1) / (2 * STEPS))
        rows = jnp.stack([table[0:-1:2], table[1::2], table[2::2]], axis=1)
        return jax.lax.scan(step, state, rows, unroll=4)[0], None

    def work(constants, state, periods):
        def body(carry, _):
            return one_period(carry, None, constants)

        return jax.lax.scan(body, state, None, length=periods)[0]

    compiled = jax.jit(work, static_argnums=2)

    def run(points: Points, periods: int) -> np.ndarray:
        p = points
        constants = tuple(jnp.asarray(a) for a in (p.zeta, p.w, p.eps, p.mean, p.force))
        state = (jnp.asarray(p.start[:, 0]), jnp.asarray(p.start[:, 1]))
        end = compiled(constants, state, periods)
        return np.stack([np.asarray(end[0]), np.asarray(end[1])], axis=1)

    return run


# --- ours -----------------------------------------------------------------------------------


def ours(method: str, precision: str = "float64", steps: int = STEPS, threads: int = 1) -> Run:
    from thermogear.dynamics.integrate import simulate

    def run(points: Points, periods: int) -> np.ndarray:
        data = simulate(
            points.model(),
            periods=1,
            discard=periods - 1,
            steps_per_period=steps,
            samples_per_period=0,
            initial_state=points.start,
            method=method,
            precision=precision,
            threads=threads,
        )
        end = [data[name].values[:, -1] for name in ("section_x", "section_v")]
        return np.stack(end, axis=1).astype(float)

    return run


EXACT = "thermogear exact maps"
LANES = "thermogear RK4 lanes"
HEYOKA = "heyoka, terminal events, machine precision"
HEYOKA_RESTARTED = "heyoka, the same, time set back every period"

MAKERS: list[tuple[str, Callable[[], Run], int, int, str]] = [
    (EXACT, lambda: ours("exact"), 512, 1000, ""),
    (LANES, lambda: ours("rk4"), 512, 200, f"{STEPS} steps, float64"),
    (f"{LANES}, 1024 steps", lambda: ours("rk4", steps=1024), 512, 100, "float64"),
    (f"{LANES}, float32", lambda: ours("rk4", "float32"), 512, 200, f"{STEPS} steps"),
    (HEYOKA, heyoka_solver, 32, 1000, "events found by a callback"),
    (
        HEYOKA_RESTARTED,
        lambda: heyoka_solver(restarted=True),
        32,
        1000,
        "as accurate as the exact maps",
    ),
    ("heyoka, terminal events, 1e-9", lambda: heyoka_solver(1e-9), 32, 1000, ""),
    ("JAX, lax.scan RK4", jax_rk4, 512, 200, f"{STEPS} steps, float64, compiled once"),
    ("numba loop as users write it", lambda: numba_loop, 64, 200, f"{STEPS} steps"),
    ("numbalsoda dop853, 1e-9", lambda: _numbalsoda("dop853"), 64, 200, ""),
    ("numbalsoda lsoda, 1e-9", lambda: _numbalsoda("lsoda"), 64, 200, ""),
    ("scipy DOP853, 1e-9", lambda: _scipy("DOP853", 1e-9), 8, 20, ""),
    ("scipy LSODA, 1e-9", lambda: _scipy("LSODA", 1e-9), 8, 40, ""),
]


def available(scale: float) -> tuple[list[Peer], dict[str, str]]:
    """The peers that run here, compiled, and why the others do not; ``scale`` of the work."""
    peers: list[Peer] = []
    missing: dict[str, str] = {}
    for name, make, points, periods, note in MAKERS:
        try:
            run = make()
        except Missing as reason:
            missing[name] = str(reason)
            continue
        points, periods = max(4, round(points * scale)), max(4, round(periods * scale))
        peers.append(Peer(name, run, points, periods, note))
    return peers, missing


def timed(peer: Peer, points: Points) -> float:
    """Point periods per second of processor time of one round: other work does not count."""
    own = points.take(peer.points)
    before = time.process_time()
    peer.run(own, peer.periods)
    return len(own) * peer.periods / (time.process_time() - before)
