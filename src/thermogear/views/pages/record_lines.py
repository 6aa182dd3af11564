"""What a terminal shows of a measured record, and of models beside one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from thermogear.base.display import SPEED
from thermogear.base.units import STANDARD_GRAVITY
from thermogear.results.result import Result

_TOLD = 5e-4
"""Weight that three digits show."""


def measured(result: Result) -> list[str]:
    """Notices, evidence, settings, and a row for each line."""
    found = result.table("figures")
    told = [f"{one.level}: {one.text}" for one in result.notices]
    told += given_and_found(found)
    told += [f"evidence: {text}" for text in found["evidence"]]
    told += [f"{name}: {value}" for name, value in result.table("settings").items()]
    if found.get("shaft_speed") is not None:
        told.append(_shaft(found))
    head = f"{'channel':12} {'line':22} {'order':>9} {'cyc/sample':>11} {'Hz':>10} {'+- Hz':>9}"
    told.append(f"{head} {'reading':>10} {'g':>9} {'um':>9} {'u_D %':>7} {'+- %':>7}")
    told += [_line(one) for one in found["lines"]]
    return told + slices(found.get("slices"))


def slices(found: Mapping[str, Any] | None) -> list[str]:
    """Greatest amplitude of every order of a run over speed, and resonances."""
    if found is None:
        return []
    what = "the mesh line" if found["of_mesh"] else "the first shaft"
    told = [
        f"orders of {what} over speed, {found['steps']} steps; where each reads highest, and the "
        "95 % interval of the greatest true amplitude of all its steps (one step alone is known "
        "better, but the highest of many is high by noise too):"
    ]
    told += [_greatest(one) for one in found["greatest"]]
    return told + [resonance(one) for one in found["resonances"]]


def _greatest(one: Mapping[str, Any]) -> str:
    interval = ""
    if "greatest_low" in one:  # not stored by older versions
        low, high = one["greatest_low"], one["greatest_high"]
        interval = f"; greatest of {one['steps']} steps {low:.5g}..{high:.5g}"
    return (
        f"{one['channel'][:12]:12} {one['name'][:22]:22} order {one['order']:9.3f}: "
        f"{one['reading']:.5g} at {SPEED(one['speed']):.5g} rpm, "
        f"{one['frequency']:.5g} Hz{interval}"
    )


def _shaft(found: Mapping[str, Any]) -> str:
    """The shaft's speed with its interval, or as a mean with its range."""
    speed, half = SPEED(found["shaft_speed"]), found["shaft_speed_half_width"]
    span = found.get("shaft_speed_range")
    if span is not None:
        low, high = (SPEED(one) for one in span)
        return f"mean shaft speed over the record: {speed:.6g} rpm (from {low:.5g} to {high:.5g})"
    around = f" +- {SPEED(half):.3g} rpm (95 %)" if half is not None else ""
    return f"shaft speed: {speed:.8g} rpm{around}"


def resonance(one: Mapping[str, Any]) -> str:
    """A peak of orders in a sentence."""
    seen = ", ".join(one["seen"])
    half = one.get("frequency_half_width", one.get("half_width"))
    place = f"{one['frequency']:.5g} +- {half:.2g} Hz"
    damping = "" if one["damping"] is None else f", damping ratio {one['damping']:.3g}"
    if one["kind"] == "resonance":
        return f"resonance at {place}{damping}: {seen} peak there at different speeds"
    if one["kind"] == "speed":
        rpm = SPEED(one["speed"])
        return f"at {rpm:.5g} rpm {seen} peak together: the speed's doing, no resonance in hertz"
    return f"{seen} alone peaks, at {place}: one order cannot tell a resonance from a speed"


def given_and_found(figures: Mapping[str, Any]) -> list[str]:
    """What the user said, and what the lines say, apart; nothing for results of older versions."""
    if "found" not in figures:
        return []
    given, found = figures["given"], figures["found"]
    said = [f"{given['teeth']} teeth"] if given["teeth"] is not None else []
    said += [f"{SPEED(given['speed']):.6g} rpm"] if given["speed"] is not None else []
    told = [f"given: {', '.join(said) if said else 'neither teeth nor speed'}"]
    if found["teeth"]:
        return [*told, f"found: {_decided(found)}"]
    told.append(f"found: {_open(found['verdict'])}")
    told += [f"weight {one['weight']:.3f}: {one['words']}" for one in found["hypotheses"]]
    if found.get("rest", 0.0) >= _TOLD:
        told.append(f"weight {found['rest']:.3f}: all other readings")
    return told


def _decided(found: Mapping[str, Any]) -> str:
    """Teeth with the weight of all readings that have them, and what is left for the others."""
    gears = reversed(found.get("gears", []))
    weights = {one["teeth"]: one["weight"] for one in gears}
    told = [
        f"{z} teeth, decided (weight {weights[z]:.4f}, of all readings without them "
        f"{1.0 - weights[z]:.4f})"
        if z in weights
        else f"{z} teeth, decided"
        for z in found["teeth"]
    ]
    return "; ".join(told)


def _open(verdict: str) -> str:
    return "no gear" if verdict == "no gear found" else "teeth undecided"


def _line(one: Mapping[str, Any]) -> str:
    return (
        f"{one['channel'][:12]:12} {one['name'][:22]:22} {_cell(one['order'], 9, 3)} "
        f"{_cell(one['position'], 11, 6)} {_cell(one['frequency'], 10, 3)} "
        f"{_cell(one['frequency_half_width'], 9, 5)} "
        f"{_cell(one['reading'], 10, 4)} {_cell(one['acceleration'], 9, 3, 1 / STANDARD_GRAVITY)} "
        f"{_cell(one['displacement'], 9, 3, 1e6)} "
        f"{_cell(_share(one, 'standard_uncertainty', 'uncertainty'), 7, 2, 100.0)} "
        f"{_cell(_share(one, 'half_width', 'half_width'), 7, 2, 100.0)}"
    )


def _share(one: Mapping[str, Any], name: str, before: str) -> float | None:
    """A relative figure of a line; results of older versions call it otherwise."""
    found: float | None = one[f"relative_{name}" if f"relative_{name}" in one else before]
    return found


def _cell(value: float | None, width: int, digits: int, factor: float = 1.0) -> str:
    return "-".rjust(width) if value is None else f"{factor * value:{width}.{digits}f}"


UNITS = {"displacement": (1e6, "um"), "frequency": (1.0, "Hz"), "acceleration": (1.0, "m/s^2")}


def comparison(result: Result) -> list[str]:
    """A row for each quantity and speed, what the lines imply, the conclusion."""
    found = result.table("figures")
    told = [f"{one.level}: {one.text}" for one in result.notices]
    for row in found["rows"]:
        factor, unit = UNITS[row["quantity"]]
        models = ", ".join(
            f"{name} {value * factor:.5g} {unit} ({100 * error:+.2f} %)"
            for name, value, error in zip(
                found["models"], row["simulated"], row["errors"], strict=True
            )
        )
        named = f"{row['record']}: " if row.get("record") else ""
        told.append(
            f"{named}{SPEED(row['speed']):.0f} rpm, {row.get('where') or row['quantity']}: "
            f"measured {row['measured'] * factor:.5g} {unit}; {models}; u_val {100 * row['u_val']:.2f} % "
            f"(num {100 * row['u_num']:.2f}, input {100 * row['u_input']:.2f}, data "
            f"{100 * row['u_data']:.2f}); {row['verdict']}"
        )
    for item in found["implied"]:
        text = f"{SPEED(item['speed']):.0f} rpm: the line implies {item['acceleration_g']:.1f} g"
        if item["shaft_speed"] is not None:
            text += f" and {SPEED(item['shaft_speed']):.1f} rpm"
        if item["offset_bins"] is not None:
            text += f", {item['offset_bins']:+.2f} bins off the nominal mesh line"
        told.append(text)
    return [*told, found["conclusion"]]
