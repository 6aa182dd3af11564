"""Run every benchmark and write bench/records/benchmarks.md and bench/results.json.

make bench                 the full run
make bench ARGS=--quick   few points, to see that everything works
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when numpy is loaded

import numpy as np

HERE = Path(__file__).parent
ROOT = HERE.parent
PERIODS_OF_ERROR = 10
BAR = "\\|"  # a bar inside a cell of a table


def spread(values: list[float]) -> list[float]:
    """min, median, max."""
    return [min(values), statistics.median(values), max(values)]


def peak_gflops() -> float:
    """Multiply-adds of one core: the best of many matrix products [1e9 flop/s]."""
    a = np.random.default_rng(0).standard_normal((1024, 1024))
    best = 0.0
    for _ in range(40):
        before = time.process_time()
        a @ a
        best = max(best, 2 * 1024**3 / (time.process_time() - before) / 1e9)
    return best


# --- accuracy -------------------------------------------------------------------------------


def sensitivity(points: Any, periods: int) -> np.ndarray:
    """Largest singular value of D P^n along every trajectory, at least 1."""
    from thermogear.dynamics import exact

    lanes = points.model().lanes()
    out = np.empty(len(points))
    for index, borders, marks in exact.layouts(lanes):
        mine = lanes.take(index)
        maps = exact.prepare_maps(mine, borders, marks)
        state = exact.State.start(
            x=points.start[index, 0], y=points.start[index, 1], backlash=mine.half_backlash
        )
        exact.advance(maps, state, periods, columns=2)
        matrices = state.tangent.T.reshape(-1, 2, 2)
        out[index] = np.linalg.norm(matrices, 2, axis=(1, 2))
    return np.maximum(out, 1.0)


def errors(peers: list[Any], points: Any, slow: int) -> list[dict[str, Any]]:
    """Largest component of the end state's error against heyoka, p50/p90/max."""
    from peers import HEYOKA

    by_name = {peer.name: peer for peer in peers}
    if HEYOKA not in by_name:
        return []
    rows = []
    # the reference restarted every period, against itself, is its own noise
    for peer in (p for p in peers if p.name != HEYOKA):
        own = points.take(slow if peer.name.startswith("scipy") else len(points))
        truth = by_name[HEYOKA].run(own, PERIODS_OF_ERROR)
        error = np.abs(peer.run(own, PERIODS_OF_ERROR) - truth).max(axis=1)
        scaled = error / sensitivity(own, PERIODS_OF_ERROR)
        rows.append({
            "name": peer.name,
            "points": len(own),
            "error": [float(np.quantile(error, q)) for q in (0.5, 0.9, 1.0)],
            "over_sensitivity": [float(np.quantile(scaled, q)) for q in (0.5, 0.9, 1.0)],
        })  # fmt: skip
    return rows


# --- speed ----------------------------------------------------------------------------------


def rates(peers: list[Any], points: Any, rounds: int) -> dict[str, list[float]]:
    """Point periods per second, every round through all peers in turn."""
    from peers import timed

    for peer in peers:
        timed(peer, points)  # compiles
    found: dict[str, list[float]] = {peer.name: [] for peer in peers}
    for _ in range(rounds):
        for peer in peers:
            found[peer.name].append(timed(peer, points))
    return found


def by_class(rounds: int, count: int) -> list[dict[str, Any]]:
    """Exact maps against heyoka and our own RK4 on motions of one kind.

    heyoka runs twice: in one call, where the rounding of its time grows with the periods and a
    second event within a cooldown is lost, and set back to time 0 every period, which follows
    every motion as accurately as the exact maps do.
    """
    from peers import EXACT, HEYOKA, HEYOKA_RESTARTED, LANES, available
    from points import classes

    peers, _ = available(1.0)
    chosen = {p.name: p for p in peers if p.name in (EXACT, HEYOKA, HEYOKA_RESTARTED, LANES)}
    if HEYOKA not in chosen:
        return []
    rows = []
    for name, points in classes(count).items():
        few = points.take(max(4, count // 32))
        speed: dict[str, list[float]] = {n: [] for n in chosen}
        for peer in chosen.values():
            peer.run(few, 4)
        for _ in range(rounds):
            for n, peer in chosen.items():
                own = few if n in (HEYOKA, HEYOKA_RESTARTED) else points
                periods = 200 if n == LANES else 1000
                before = time.process_time()
                end = peer.run(own, periods)
                speed[n].append(len(own) * periods / (time.process_time() - before))
                if n == HEYOKA:  # teeth in free flight for ever: a contact was missed
                    lost = float(np.mean(np.abs(end[:, 0]) > 100.0))
        truth = chosen[HEYOKA_RESTARTED].run(few, PERIODS_OF_ERROR)
        ours = chosen[EXACT].run(few, PERIODS_OF_ERROR)
        error = np.abs(ours - truth).max(axis=1) / sensitivity(few, PERIODS_OF_ERROR)
        against = {
            other: spread([a / b for a, b in zip(speed[EXACT], speed[other], strict=True)])
            for other in (HEYOKA, HEYOKA_RESTARTED, LANES)
        }
        rows.append({
            "class": name,
            "crossings": crossings(few),
            "exact": spread(speed[EXACT]),
            "against_heyoka": against[HEYOKA],
            "heyoka_lost": lost,
            "against_heyoka_restarted": against[HEYOKA_RESTARTED],
            "against_lanes": against[LANES],
            "error_over_sensitivity_p90": float(np.quantile(error, 0.9)),
        })  # fmt: skip
    return rows


def crossings(points: Any) -> float:
    """Edges crossed in a period, mean over the points."""
    from thermogear.dynamics.integrate import simulate

    data = simulate(
        points.model(), periods=50, samples_per_period=64, initial_state=points.start,
        method="exact",
    )  # fmt: skip
    x = data["x"].values
    side = (x > 1.0).astype(int) - (x < -1.0).astype(int)
    return float(np.abs(np.diff(side, axis=1)).sum() / (50 * len(points)))


def lyapunov_cost(points: Any, rounds: int, periods: int) -> list[float]:
    """Time with one tangent column over time without, by rounds."""
    from thermogear.dynamics import exact

    lanes = points.model().lanes()
    blocks = []
    for index, borders, marks in exact.layouts(lanes):
        mine = lanes.take(index)
        maps = exact.prepare_maps(mine, borders, marks)
        state = exact.State.start(
            x=points.start[index, 0], y=points.start[index, 1], backlash=mine.half_backlash
        )
        exact.advance(maps, state, 20)
        exact.advance(maps, state, 2, columns=1, normalise=True)
        blocks.append((maps, state))

    def once(columns: int) -> float:
        before = time.process_time()
        for maps, state in blocks:
            exact.advance(maps, state, periods, columns=columns, normalise=columns > 0)
        return time.process_time() - before

    ratios = []
    for _ in range(rounds):
        plain = once(0)
        ratios.append(once(1) / plain)
    return spread(ratios)


def two_threads(points: Any, rounds: int, scale: float) -> dict[str, list[float]]:
    """Time of one thread over time of two, by rounds; results are the same bits."""
    from peers import ours

    os.sched_setaffinity(0, ALL_CORES)
    found = {}
    for name, full in (("exact", 2000), ("rk4", 400)):
        periods = max(20, round(scale * full))
        single, double = ours(name, threads=1), ours(name, threads=2)
        same = np.array_equal(single(points, 4), double(points, 4))
        if not same:
            raise SystemExit(f"{name}: results differ between one and two threads")
        ratios = []
        for _ in range(rounds):
            before = time.perf_counter()
            single(points, periods)
            middle = time.perf_counter()
            double(points, periods)
            ratios.append((middle - before) / (time.perf_counter() - middle))
        found[name] = spread(ratios)
    os.sched_setaffinity(0, ONE_CORE)
    return found


START = """
import time
t = [time.process_time()]
import numba, numpy as np
@numba.njit(cache=True)
def trivial(x):
    return x + 1.0
trivial(1.0)
t.append(time.process_time())
from thermogear.analysis.lyapunov import lyapunov_exponent
from thermogear.analysis.orbits import periodic_orbit
from thermogear.dynamics.models import TorsionalModel
t.append(time.process_time())
m = TorsionalModel(damping_ratio=0.1535, frequency=1.245, stiffness_amplitude=0.1,
                   mean_force=0.017, force_amplitude=-1.16)
periodic_orbit(m, 1, (1.08, -0.25))
lyapunov_exponent(m, discard=2, batches=2, batch_periods=2)
t.append(time.process_time())
import xarray
t.append(time.process_time())
from thermogear.dynamics.integrate import simulate
t.append(time.process_time())
simulate(m, periods=2, method="exact")
simulate(m, periods=2, method="rk4")
t.append(time.process_time())
print(*np.diff(t))
"""
PARTS = ("numba", "package", "exact", "xarray", "simulate", "rk4")


def starts(rounds: int) -> dict[str, Any]:
    """Seconds to compile everything cold, and what a cached start costs above numba's own."""
    cold, cached = [], []
    for _ in range(max(1, rounds // 3)):
        with tempfile.TemporaryDirectory() as cache:
            script = Path(cache) / "start.py"
            script.write_text(START, encoding="utf-8")
            environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
            for again in range(4):
                done = subprocess.run(
                    [sys.executable, str(script)], env=environment, capture_output=True,
                    text=True, check=True,
                )  # fmt: skip
                spent = dict(zip(PARTS, map(float, done.stdout.split()), strict=True))
                if again == 0:
                    cold.append(spent["exact"] + spent["rk4"])
                elif again > 1:
                    cached.append(spent)
    middle = {part: statistics.median(spent[part] for spent in cached) for part in PARTS}
    return {"cold_compile_s": spread(cold), "cached_s": middle}


# --- the page -------------------------------------------------------------------------------


def flops(name: str, substeps: float) -> float | None:
    """Floating-point operations of one period, where they are known by count."""
    if name.startswith("thermogear exact"):
        return 12.0 * substeps
    if "RK4" in name or "numba loop" in name:
        return 38.0 * (1024 if "1024" in name else 256)
    return None


def sig(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}g}"


def three(values: list[float], digits: int = 3) -> str:
    return " / ".join(sig(v, digits) for v in values)


def page(found: dict[str, Any]) -> str:
    """bench/records/benchmarks.md."""
    from peers import EXACT, LANES

    speed = found["rates"]
    lines = [
        "# Benchmarks",
        "",
        "Written by `make bench`; do not edit. Everything on one core unless said otherwise, every",
        "round runs all solvers in turn, ratios are taken round by round. Rates and ratios count",
        "processor time, set-up and call included, over 200 periods or more (scipy fewer). The",
        f"points: {found['points']} random parameter sets, half of them rattling with |F_h|/F_m",
        "from 5 to 70. Three numbers are min / median / max over the rounds.",
        "",
        f"Machine: {found['machine']}; {found['rounds']} rounds. {found['shared']}",
        "",
        "## Speed",
        "",
        "| solver | mesh periods/s (median) | exact maps are faster by | RK4 lanes are faster by "
        "| share of multiply-add peak |",
        "|---|---|---|---|---|",
    ]
    for name, values in speed.items():
        exact = [a / b for a, b in zip(speed[EXACT], values, strict=True)]
        lanes = [a / b for a, b in zip(speed[LANES], values, strict=True)]
        count = flops(name, found["substeps"])
        share = "–"
        if count is not None:
            share = f"{100 * statistics.median(values) * count / 1e9 / found['peak_gflops']:.1f} %"
        note = found["notes"].get(name, "")
        full = f"{name} ({note})" if note else name
        lines.append(
            f"| {full} | {statistics.median(values):,.0f} | {three(spread(exact))} "
            f"| {three(spread(lanes))} | {share} |"
        )
    for name, reason in found["missing"].items():
        lines.append(f"| {name} | not installed: {reason} | – | – | – |")
    lines += [
        "",
        f"Peak: {found['peak_gflops']:.1f} Gflop/s, the best of many matrix products on the same",
        "core. Counted are 38 operations a Runge-Kutta step and 12 a sub-step of the exact maps",
        f"({found['substeps']:.0f} sub-steps a period here); crossings come on top.",
        "",
        "## Accuracy",
        "",
        f"State after {PERIODS_OF_ERROR} periods against heyoka at machine precision, largest",
        "component. In rattling sets an error grows with the orbit, so it also stands over the",
        "orbit's own sensitivity |D Pⁿ|.",
        "",
        "| solver | points | error: median / p90 / max | over sensitivity: median / p90 / max |",
        "|---|---|---|---|",
    ]
    for row in found["errors"]:
        lines.append(
            f"| {row['name']} | {row['points']} | {three(row['error'], 2)} "
            f"| {three(row['over_sensitivity'], 2)} |"
        )
    lines += [
        "",
        "## Exact maps by kind of motion",
        "",
        "heyoka runs 1000 periods in two ways: in one call, where the rounding of its time grows",
        "(1e-12 in the end) and a second event within its cooldown is missed, and set back to",
        "time 0 every period, which is as accurate as the exact maps and follows grazing too.",
        "",
        "| motion | crossings a period | periods/s | against heyoka, one call "
        "| against heyoka, set back every period | against RK4 lanes, 256 steps "
        "| p90 error over sensitivity |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in found["classes"]:
        plain = three(row["against_heyoka"])
        if row["heyoka_lost"] > 0.0:
            plain = f"its {100 * row['heyoka_lost']:.0f} % of points lost the contact ({plain})"
        lines.append(
            f"| {row['class'].replace('|', BAR)} | {row['crossings']:.1f} | {row['exact'][1]:,.0f} "
            f"| {plain} | {three(row['against_heyoka_restarted'])} "
            f"| {three(row['against_lanes'])} "
            f"| {sig(row['error_over_sensitivity_p90'], 2)} |"
        )
    cached = found["starts"]["cached_s"]
    engine = cached["package"] + cached["exact"]
    everything = engine + cached["simulate"] + cached["rk4"]
    lines += [
        "",
        "## Costs",
        "",
        "| what | min / median / max |",
        "|---|---|",
        f"| largest Lyapunov exponent over the plain run | {three(found['lyapunov'])} |",
        *(
            f"| two threads against one, {name} | {three(values)} |"
            for name, values in found["threads"].items()
        ),
        "| cold compile of exact, RK4 and tangent kernels [s of processor time] "
        f"| {three(found['starts']['cold_compile_s'])} |",
        "| cached start above numba and one trivial kernel: orbits and Lyapunov exponents "
        f"[s of processor time] | {sig(engine)} (imports {sig(cached['package'])}, kernels "
        f"{sig(cached['exact'])}) |",
        f"| the same with `simulate` and the RK4 kernel [s of processor time] | {sig(everything)} "
        f"and {sig(cached['xarray'])} for importing xarray |",
        "| importing numba and loading one trivial kernel [s of processor time] "
        f"| {sig(cached['numba'])} |",
        "",
        "`simulate` returns an xarray Dataset, so it imports xarray (and with it pandas); orbits,",
        "labels and exponents do not. Results are the same bits on one thread and on two.",
        "",
        "## Mesh stiffness",
        "",
    ]
    lines += stiffness_lines(found["stiffness"])
    return "\n".join(lines) + "\n"


def stiffness_lines(s: dict[str, Any]) -> list[str]:
    if "missing" in s:
        return [f"ROSS could not be used: {s['missing']}."]
    worst = max(abs(e["difference"]) for e in s["elements"] if "Sainsot" not in e["part"])
    lines = [
        "m 5 mm, 25/75 teeth, bores 20/60 mm, b 20 mm, F_n/b 200 N/mm, against ROSS 2.3. Tooth",
        f"elements agree within {worst:.1e}; the body term differs because ROSS measures u_f from",
        "the contact point instead of where the line of action meets the tooth axis.",
        "",
        "| gear | element | ours [N/m] | ROSS [N/m] | difference |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {e['gear']} | {e['part']} | {e['ours']:.6g} | {e['ross']:.6g} | {e['difference']:.1e} |"
        for e in s["elements"]
    ]
    names = {
        "ross": "ROSS", "ours_loaded": "loaded contact", "ours_textbook": "our textbook sum",
    }  # fmt: skip
    lines += [
        "",
        "| whole mesh | mean [N/m] | max [N/m] | two pairs against finite elements "
        "| one pair | seconds per 1000 positions |",
        "|---|---|---|---|---|---|",
    ]
    for key, name in names.items():
        apart = s["against_elements"][key]
        lines.append(
            f"| {name} | {s['mean'][key]:.4g} | {s['max'][key]:.4g} "
            f"| {100 * apart['two pairs']:+.1f} % | {100 * apart['one pair']:+.1f} % "
            f"| {sig(s['seconds'][key])} |"
        )
    low, middle, high = s["ratio_to_ross"]
    lines += [
        "",
        f"The loaded contact, with load sharing, is {low:,.0f} / {middle:,.0f} / {high:,.0f} times "
        "as fast as ROSS per",
        f"position with the body series cached; {s['first_call_ratio']:.0f} times on a first call "
        f"({sig(s['first_call_s'])} s, code compiled,",
        "body series cold). ROSS stands higher because its teeth do not move under their",
        "neighbours' load and its beams start at the root circle; it shares no load.",
    ]
    return lines


def machine() -> str:
    name = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                name = line.split(":", 1)[1].strip()
                break
    except OSError:
        name = platform.machine()
    tools = []
    for package in ("numpy", "numba", "scipy", "heyoka", "jax", "numbalsoda", "ross-rotordynamics"):
        try:
            tools.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            tools.append(f"{package} absent")
    cores = len(ALL_CORES)
    return f"{name}, {cores} cores, Python {platform.python_version()}, {', '.join(tools)}"


ALL_CORES = os.sched_getaffinity(0)
ONE_CORE = {min(ALL_CORES)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few points, to see that it works")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--output", type=Path, default=ROOT / "bench" / "records" / "benchmarks.md")
    arguments = parser.parse_args()
    quick = arguments.quick
    rounds = 2 if quick else arguments.rounds
    warnings.simplefilter("ignore")
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")
    os.sched_setaffinity(0, ONE_CORE)
    sys.path.insert(0, str(HERE))

    from peers import available
    from points import random_points

    load = os.getloadavg()[0]
    points = random_points(64 if quick else 512)

    def said(what: str) -> None:
        print(f"{time.strftime('%H:%M:%S')} {what}", file=sys.stderr, flush=True)

    said("peers")
    peers, missing = available(0.1 if quick else 1.0)
    found: dict[str, Any] = {
        "points": len(points),
        "rounds": rounds,
        "machine": machine(),
        "missing": missing,
        "notes": {p.name: p.note for p in peers},
        "peak_gflops": peak_gflops(),
    }
    from thermogear.dynamics import exact

    found["substeps"] = float(exact.substeps(points.model().lanes()).mean())
    said("errors")
    found["errors"] = errors(peers, points, 8 if quick else 32)
    said("rates")
    found["rates"] = rates(peers, points, rounds)
    said("classes")
    found["classes"] = by_class(rounds, 16 if quick else 512)
    said("lyapunov")
    found["lyapunov"] = lyapunov_cost(points, rounds, 20 if quick else 200)
    said("threads")
    found["threads"] = two_threads(points, rounds, 0.01 if quick else 1.0)
    said("starts")
    found["starts"] = starts(rounds)
    said("stiffness")
    try:
        from stiffness import compare

        found["stiffness"] = compare(1 if quick else 3)
    except ImportError as error:
        found["stiffness"] = {"missing": str(error)}
    busy = max(load, os.getloadavg()[0])
    found["load_average"] = busy
    cores = len(ALL_CORES)
    found["shared"] = (
        f"Other work ran beside it (load average {busy:.1f} on {cores} cores): rates are lower "
        "than on a machine of its own, and two threads had no second core to themselves."
        if busy > 1.7
        else "No other work of ours ran beside it; what neighbours on one host took stands in the "
        "spread."
    )
    said("written")
    arguments.output.write_text(page(found), encoding="utf-8")
    store = arguments.output.with_suffix(".json")
    store.write_text(json.dumps(found, indent=1, default=float) + "\n", encoding="utf-8")
    print(arguments.output)


if __name__ == "__main__":
    main()
