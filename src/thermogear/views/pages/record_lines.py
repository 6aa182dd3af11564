"""What a terminal shows of a measured record, and of models beside one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from thermogear.base.display import SPEED
from thermogear.results.result import Result
from thermogear.views.page import Block, Text
from thermogear.views.pages.record_tables import comparison_tables, line_table

_TOLD = 5e-4
"""Weight that three digits show."""


def measured(result: Result) -> list[Block]:
    """Evidence, settings, and a row for each line."""
    found = result.table("figures")
    told = given_and_found(found)
    told += [f"evidence: {text}" for text in found["evidence"]]
    told += [f"{name}: {value}" for name, value in result.table("settings").items()]
    if found.get("shaft_speed") is not None:
        told.append(_shaft(found))
    table = line_table(result)
    tables = [table] if table else []
    return [*map(Text, told), *tables, *map(Text, slices(found.get("slices")))]


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


def comparison(result: Result) -> list[Block]:
    """The tables of the page, the conclusion."""
    return [*comparison_tables(result), Text(result.table("figures")["conclusion"])]


TOLD = {"measured": measured, "comparison": comparison}
