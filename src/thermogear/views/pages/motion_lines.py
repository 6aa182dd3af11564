"""What a terminal shows of one motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from thermogear.views.pages.event_plane import plane_lines, shown


def _orbit_lines(s: dict[str, Any]) -> list[str]:
    si = s["units"] == "SI"
    scale, unit = (1e6, " um") if si else (1.0, "")
    share = s["time_share"]
    factor = s["dynamic_load_factor"]
    lines = [
        s["title"],
        f"  period                 {s['period']} ({'stable' if s['stable'] else 'unstable'})",
        f"  state at phase 0       {s['state'][0]:.12g}, {s['state'][1]:.12g}  (X, X')",
    ]
    for number, mu in enumerate(s["multipliers"], start=1):
        imag = f" {mu['imag']:+.9f}i" if mu["imag"] else ""
        lines.append(
            f"  Floquet multiplier {number}   {mu['real']:+.9f}{imag}  "
            f"(modulus {mu['modulus']:.9f})"
        )
    lines += [
        f"  losses of contact      {s['contact_losses']} per orbit",
        f"  back-side impacts      {s['back_impacts']} per orbit",
        f"  time                   {100 * share['drive']:.4g} % drive contact, "
        f"{100 * share['free']:.4g} % free, {100 * share['back']:.4g} % back contact",
        f"  dynamic load factor    {'infinite' if factor is None else f'{factor:.6g}'}",
        f"  displacement           {s['least'] * scale:.6g} .. {s['greatest'] * scale:.6g}{unit}"
        f" (edge of the backlash {s['half_backlash'] * scale:.6g}{unit})",
        "  greatest lines         order     amplitude" + ("       f [Hz]" if si else ""),
    ]
    for line in sorted(s["lines"], key=lambda one: -float(one["amplitude"]))[:8]:
        hertz = f"{line['frequency_hz']:13.6g}" if si else ""
        mark = "  half order" if line["half_order"] else ""
        lines.append(f"{line['order']:28.4g} {line['amplitude'] * scale:13.6g}{hertz}{mark}")
    return lines


def _lyapunov_lines(s: dict[str, Any]) -> list[str]:
    lines = [
        s["title"],
        f"  lambda_1               {s['exponent']:.6f} +- {s['error']:.6f}  ({s['verdict']})",
        f"  lambda_2               {s['second']:.6f}",
        f"  sum                    {s['sum']:.9g}  (-2 zeta, exactly)",
        f"  Kaplan-Yorke dimension {s['kaplan_yorke']:.5f}  (of the section)",
        f"  per mesh period        {s['per_mesh_period']:.6f}",
    ]
    if s["per_second"] is not None:
        lines.append(f"  per second             {s['per_second']:.6g} 1/s")
    lines.append(f"  batches                {s['batches']} of {s['batch_periods']} periods")
    return lines


def _branch_lines(s: dict[str, Any]) -> list[str]:
    lines = [s["title"]]
    if "train" in s:
        train = s["train"]
        lines.append(f"  drive train in {train['coordinates']} coordinates; {train['began']}")
        straight = train.get("straight")
        if straight is not None:
            lines.append(
                f"  half way between computed values the greatest mesh force is off by "
                f"{100.0 * straight['force']:.2g} %, the largest multiplier by "
                f"{straight['multiplier']:.2g}"
            )
    for event in s["bifurcations"]:
        mu = event["multipliers"][0]
        imag = f"{mu['imag']:+.6f}i" if mu["imag"] else ""
        note = f"  {event['note']}" if event["note"] else ""
        lines.append(
            f"  {event['kind']:<16} period {event['period']:<3} {s['parameter']} = "
            f"{shown(event, 10):<18} multiplier {mu['real']:+.6f}{imag}{note}"
        )
    for branch in s["branches"]:
        lines.append(
            f"  branch of period {branch['period']}: {branch['points']} orbits, "
            f"{branch['stable_points']} stable; {branch['ended']}"
        )
    return lines + plane_lines(s)


def _cascade_lines(s: dict[str, Any]) -> list[str]:
    lines = [s["title"]]
    for row in dict.fromkeys(c["row"] for c in s["cascades"]):
        own = [c for c in s["cascades"] if c["row"] == row]
        lines.append(f"\n{row}: {own[0]['parameter']} {own[0]['from']:g} to {own[0]['to']:g}")
        names = [c["heat"].split(" (")[0] for c in own]
        lines.append("  flip     " + " ".join(f"{name:>20}" for name in names))
        for k in range(s["flips"]):
            cells = [
                f"{c['flips'][k]['value']:20.9f}" if k < len(c["flips"]) else f"{'-':>20}"
                for c in own
            ]
            lines.append(f"  {2**k:>2} -> {2 ** (k + 1):<3} " + " ".join(cells))
        for c in own:
            lines += [
                f"  {c['heat']}: {f['from_period']} -> {f['to_period']} {f['note']}"
                for f in c["flips"]
            ]
            if len(c["flips"]) < s["flips"]:
                lines.append(f"  {c['heat']}: no further flip, {c['ended']}")
    heats = dict.fromkeys(c["heat"] for c in s["cascades"] if c["heat"] != "cold")
    return lines + ([""] + [f"heat: {name}" for name in heats] if heats else [])


def _shared_lines(s: dict[str, Any]) -> list[str]:
    lines = [s["title"], "  load-shared against one spring, difference (of the transmission error)"]
    for where in ("mean", "light"):
        for words, name in (
            ("mean stiffness", f"stiffness_at_{where}_load"),
            ("error at rest, peak to peak", f"swing_at_rest_{where}_load"),
            ("error over speed, median", f"median_swing_in_motion_{where}_load"),
            ("error over speed, greatest", f"swing_in_motion_{where}_load"),
        ):
            if name in s:
                lines.append(f"  {where:>5} load: {words:<34} {100 * s[name]:7.2f} %")
    if "mean_clearance_m" in s:
        mean, least, apart = (s[f"{name}_m"] for name in (
            "mean_clearance", "least_clearance", "clearance_apart"))  # fmt: skip
        lines.append(
            f"  free play 2b': mean {1e6 * mean:.2f} um, least {1e6 * least:.2f} um, "
            f"forms {1e9 * apart:.2g} nm apart"
        )
    return lines


LINES: dict[str, Callable[[dict[str, Any]], list[str]]] = {
    "orbit": _orbit_lines,
    "lyapunov": _lyapunov_lines,
    "branch": _branch_lines,
    "cascade": _cascade_lines,
    "shared": _shared_lines,
}
