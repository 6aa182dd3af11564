"""A small results.nc with every group, made of closed forms: no run behind it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import xarray as xr

from thermogear.base.netcdf import write_tree
from thermogear.base.vocabulary import STATUS, label

PINION_TEETH = 25
POINTS = {"A": 0.008, "B": 0.0185, "C": 0.0214, "D": 0.0227, "E": 0.0333}
PERIODS, SAMPLES, SECTION = 4, 32, 12
BSO = ("bundle", "state", "operating")
BTO = ("bundle", "gear_temperature", "operating")


def build(
    directory: Path,
    *,
    bundles: tuple[str, ...] = ("consistent", "thesis"),
    without: tuple[str, ...] = (),
    jammed: bool = False,
    title: str = "A pair",
    torques: tuple[float, ...] = (100.0, 100.0),
    **attributes: str,
) -> Path:
    """Write ``directory/results.nc``; ``without`` names groups that are left out."""
    groups = {
        "path": path_group(bundles, torques),
        "mesh": mesh_group(bundles, torques, jammed),
        "profile": profile_group(),
        "motion": motion_group(bundles, torques, ("undeformed", "hot"), "state", jammed),
        "dial": dial_group(jammed),
        "temperature": temperature_group(bundles, torques, jammed),
        "base_sets/table-4.2": points_group(),
        "base_sets/section-4.1": points_group("temperature", (293.15, 413.15), "K"),
    }
    kept = {name: data for name, data in groups.items() if name not in without}
    return write(directory, kept, title=title, kind="gear", bundles=json.dumps(
        {name: {"flank": name, "dry_coefficient": 0.2} for name in bundles}
    ), **attributes)  # fmt: skip


def build_dimensionless(directory: Path, title: str = "Rows") -> Path:
    """A results.nc of a dimensionless case."""
    return write(directory, {"points": points_group()}, title=title, kind="dimensionless")


def write(directory: Path, groups: dict[str, xr.Dataset], **attributes: str) -> Path:
    tree = xr.DataTree.from_dict(groups)
    tree.attrs = {
        "thermogear": "0.0.0",
        "case": "title = 'A pair'\n# <b>bold</b>\n",
        "created": "2001-02-03T04:05:06+00:00",
        "environment": json.dumps({"python": "3.11"}),
        "assumptions": json.dumps([{"field": "oil.name", "value": "M100", "reason": "usual"}]),
        "notices": json.dumps([{"level": "info", "text": "quiet"},
                               {"level": "important", "text": "two regimes, -3 um"}]),
        "citations": json.dumps([{"key": "k", "text": "Blok 1937", "used_for": "flash"}]),
        "errata": json.dumps([{"number": 1, "printed": "flash", "problem": "K m",
                               "value_as_printed": 0.0024, "value_repaired": 21.2, "unit": "K"}]),
        "facts": json.dumps([{"group": "geometry", "name": "contact ratio", "value": 1.714426,
                              "unit": "1"}]),
        **attributes,
    }  # fmt: skip
    directory.mkdir(parents=True, exist_ok=True)
    write_tree(tree, directory / "results.nc")
    return directory


def _operating(torques: tuple[float, ...]) -> dict[str, object]:
    speed = np.array([1000.0, 2000.0, 3000.0][: len(torques)]) * np.pi / 30.0
    return {"pinion_speed": (("operating",), speed), "pinion_torque": (("operating",), torques)}


def _full(shape: tuple[int, ...], curve: np.ndarray) -> np.ndarray:
    """``curve`` for every bundle and state, a little different in each."""
    scale = 1.0 + 0.1 * np.arange(np.prod(shape)).reshape(*shape, 1)
    return scale * curve


def path_group(bundles: tuple[str, ...], torques: tuple[float, ...]) -> xr.Dataset:
    s = np.linspace(POINTS["A"], POINTS["E"], 21)
    shape = (len(bundles), 2, len(torques))
    dims = (*BSO, "path_position")
    slide = np.abs(s - POINTS["C"])
    curves = {
        "load_share": np.where((s > POINTS["B"]) & (s < POINTS["D"]), 1.0, 0.5),
        "line_load": 6e4 + 0.0 * s,
        "hertz_half_width": 1e-4 + 0.001 * s,
        "hertz_pressure": 4e8 - 1e9 * s,
        "friction_coefficient": 0.05 + 0.0 * s,
        "friction_coefficient_mixed": 0.05 + 0.0 * s,
        "friction_coefficient_dry": 0.2 + 0.0 * s,
        "flash_temperature": 1000.0 * slide,
        "flash_temperature_mixed": 1000.0 * slide,
        "flash_temperature_dry": 4000.0 * slide,
        "pinion_deformation": 2e-5 + 0.001 * s,
        "wheel_deformation": 8e-5 - 0.001 * s,
        "deformation_sum": 1e-4 + 0.0 * s,
    }
    variables: dict[str, object] = {n: (dims, _full(shape, c)) for n, c in curves.items()}
    body = np.array([293.15, 413.15])[None, :, None, None] + np.zeros((*shape, s.size))
    for name in ("pinion_body_temperature", "wheel_body_temperature", "contact_temperature"):
        variables[name] = (dims, body + (100.0 * slide if name.startswith("contact") else 0.0))
    speeds = {
        "pinion_rolling_velocity": s,
        "wheel_rolling_velocity": 0.0855 - s,
        "sliding_velocity": 2.0 * s - 0.0855,
        "entrainment_velocity": 0.04275 + 0.0 * s,
    }
    for name, curve in speeds.items():
        variables[name] = (
            ("operating", "path_position"),
            np.outer(np.arange(1, 1 + shape[2]), curve),
        )
    coordinates = {**_operating(torques), "path_position": (("path_position",), s)}
    data = label(variables, coordinates, {"path_points": json.dumps(POINTS)})
    return data.assign_coords(bundle=list(bundles), state=["undeformed", "hot"])


def mesh_group(bundles: tuple[str, ...], torques: tuple[float, ...], jammed: bool) -> xr.Dataset:
    phase = np.arange(16) / 16
    s = np.linspace(POINTS["A"], POINTS["E"], 21)
    shape = (len(bundles), 2, len(torques))
    k = np.where(phase < 0.7, 6e8, 3.5e8)
    gap = np.full(shape, 1.25e-4)
    gap[:, 1] = -1e-5 if jammed else 9e-5
    variables: dict[str, object] = {
        "mesh_stiffness": ((*BSO, "mesh_phase"), _full(shape, k)),
        "elastic_stiffness": ((*BSO, "mesh_phase"), _full(shape, k)),
        "thermal_stiffness": ((*BSO, "mesh_phase"), _full(shape, 0.0 * k + 1e6)),
        "half_backlash_curve": ((*BSO, "mesh_phase"), gap[..., None] + 0.0 * phase),
        "half_backlash": (BSO, gap),
        "cold_half_backlash": (BSO, np.full(shape, 1.25e-4)),
        "jam_temperature": (BSO, np.full(shape, 341.15 if jammed else 508.15)),
        "status": (BSO, (gap < 0.0).astype(np.int8)),
    }
    for place, name in enumerate(
        ("hertz", "pinion_bending", "wheel_bending", "pinion_body", "wheel_body", "pair")
    ):
        curve = (place + 1.0) * 1e9 + 1e9 * s
        variables[f"{name}_stiffness"] = ((*BSO, "path_position"), _full(shape, curve))
    figures = {
        "mean_stiffness": 5.4e8, "peak_to_peak_stiffness": 2.8e8, "mid_range_stiffness": 4.9e8,
        "natural_frequency": 3400.0, "frequency_ratio": 0.12, "stiffness_amplitude": 0.2,
        "thermal_stiffness_ratio": -0.03, "mean_force": 0.03, "force_amplitude": 0.001,
        "half_backlash_ratio": 0.75, "damping_ratio": 0.07,
    }  # fmt: skip
    for name, value in figures.items():
        variables[name] = (BSO, _full(shape, np.array([value]))[..., 0])
    coordinates = {
        **_operating(torques),
        "mesh_phase": (("mesh_phase",), phase),
        "path_position": (("path_position",), s),
    }
    data = label(variables, coordinates, {"path_points": json.dumps(POINTS)})
    return data.assign_coords(bundle=list(bundles), state=["undeformed", "hot"])


def profile_group() -> xr.Dataset:
    y = np.linspace([0.059, 0.183], [0.0675, 0.1925], 15).T
    x = 0.004 - 0.3 * (y - y[:, :1])
    columns = {
        "involute": (x, y),
        "printed": (x + 1e-5, y + 8e-5),
        "consistent": (x + 2e-5, y + 8e-5),
    }
    data = xr.Dataset({
        f"{name}_{axis}": (("gear", "profile_point"), values, {"units": "m"})
        for name, pair in columns.items()
        for axis, values in zip("xy", pair, strict=True)
    })  # fmt: skip
    return data.assign_coords(gear=["pinion", "wheel"]).assign_attrs(magnification=1)


def motion_group(
    bundles: tuple[str, ...], torques: tuple[float, ...], places: object, axis: str, jammed: bool
) -> xr.Dataset:
    """x = b' + 3 um + 1 um cos(2 pi f t): one line of 1 um at the mesh frequency."""
    dims = ("bundle", axis, "operating")
    shape = (len(bundles), len(places), len(torques))  # type: ignore[arg-type]
    coordinates = _operating(torques)
    mesh = PINION_TEETH * np.asarray(coordinates["pinion_speed"][1]) / (2 * np.pi)  # type: ignore[index]
    phase = np.arange(PERIODS * SAMPLES) / SAMPLES
    order = np.arange(0, 64) / 8.0
    ones = np.ones((*shape, 1))
    rate = 2 * np.pi * mesh[:, None] * ones
    line = np.where(order == 1.0, 1e-6, 1e-22)
    values = {
        "displacement": 9.3e-5 + 1e-6 * np.cos(2 * np.pi * phase) * ones,
        "velocity": -1e-6 * rate * np.sin(2 * np.pi * phase),
        "section_displacement": np.full((*shape, SECTION), 9.4e-5),
        "section_velocity": np.full((*shape, SECTION), 0.0),
        "line_amplitude": line * ones,
        "half_order_amplitude": 1e-22 * ones[..., 0],
        "peak_to_peak_displacement": 2e-6 * ones[..., 0],
        "contact_loss_share": 0.0 * ones[..., 0],
        "back_impacts": 0.0 * ones[..., 0],
    }
    labels = np.full(shape, "period-1", dtype="U9")
    reasons = np.full(shape, "multiplier -0.3", dtype="U40")
    status = np.zeros(shape, np.int8)
    if jammed:
        for array in values.values():
            array[:, -1] = np.nan
        labels[:, -1], reasons[:, -1] = "jammed", "no clearance is left"
        status[:, -1] = STATUS.index("jammed")
    tail = dict.fromkeys(("section_displacement", "section_velocity"), ("section",))
    tail |= dict.fromkeys(("displacement", "velocity"), ("sample",))
    tail["line_amplitude"] = ("order",)
    variables: dict[str, object] = {n: ((*dims, *tail.get(n, ())), v) for n, v in values.items()}
    variables |= {
        "status": (dims, status),
        "time": (("operating", "sample"), phase / mesh[:, None]),
        "order": (("order",), order),
        "line_frequency": (("operating", "order"), order * mesh[:, None]),
    }
    kept = {n: v for n, v in variables.items() if n != "peak_to_peak_displacement"}
    data = label(kept, coordinates, {"bin_width_orders": 0.125, "periods": 8, "discarded": 4})
    data["peak_to_peak_displacement"] = (dims, values["peak_to_peak_displacement"], {"units": "m"})
    data["label"], data["label_reason"] = (dims, labels), (dims, reasons)
    return data.assign_coords(bundle=list(bundles), **{axis: list(places)})  # type: ignore[call-overload]


def temperature_group(
    bundles: tuple[str, ...], torques: tuple[float, ...], jammed: bool
) -> xr.Dataset:
    temperatures = np.array([373.15, 413.15, 433.15])
    data = motion_group(bundles, torques, temperatures, "gear_temperature", jammed)
    shape = tuple(data.sizes[d] for d in BTO)
    gap = np.full(shape, 9e-5)
    if jammed:
        gap[:, -1] = -1e-6
    figures = label({
        "half_backlash": (BTO, gap),
        "cold_half_backlash": (BTO, np.full(shape, 1.25e-4)),
        "jam_temperature": (BTO, np.full(shape, 430.0)),
        "mean_stiffness": (BTO, np.full(shape, 5e8)),
    })  # fmt: skip
    return data.assign(figures.data_vars)


def dial_group(jammed: bool = False) -> xr.Dataset:
    """The first operating point at three temperatures; the last one jammed, if any is."""
    data = temperature_group(("c",), (100.0,), False).isel(bundle=0, operating=0, drop=True)
    kept = data.drop_vars(["cold_half_backlash", "jam_temperature"])
    gap = np.array([1.04e-4, 9.3e-5, 8.6e-5])
    if jammed:
        gap[-1] = -1e-6
        for name in ("displacement", "velocity"):
            kept[name][-1] = np.nan
        kept["status"][-1], kept["label"][-1] = STATUS.index("jammed"), "jammed"
    phase = np.linspace(0.0, 1.0, 33)
    curve = 5e8 + 1e8 * np.sign(np.cos(2 * np.pi * phase)) * np.array([[1.0], [0.9], [0.8]])
    curves = label(
        {"mesh_stiffness": (("gear_temperature", "mesh_phase"), curve)}, {"mesh_phase": phase}
    )
    found = kept.assign(half_backlash=("gear_temperature", gap)).merge(curves)
    return found.assign_attrs(
        start=1, jam_temperature=430.0, pinion_speed=104.7, pinion_torque=100.0, jammed=int(jammed)
    )


def points_group(
    parameter: str = "damping_ratio", swept: tuple[float, ...] = (0.18, 0.1), unit: str = "1"
) -> xr.Dataset:
    """Two points: a circle, and a cloud that carries the label chaotic."""
    phase = np.arange(8 * SAMPLES) / SAMPLES
    order = np.arange(0, 40) / 8.0
    x = np.stack([np.cos(2 * np.pi * phase), np.cos(2 * np.pi * phase) + 0.1 * np.cos(phase**2)])
    v = -np.stack([np.sin(2 * np.pi * phase)] * 2)
    noise = np.linspace(0.9, 1.1, SECTION)
    section = np.stack([np.ones(SECTION), noise])
    variables: dict[str, object] = {
        "scaled_displacement": (("point", "sample"), x),
        "scaled_velocity": (("point", "sample"), v),
        "section_displacement": (("point", "section"), section),
        "section_velocity": (("point", "section"), 0.1 * section),
        "order": (("order",), order),
        "line_amplitude": (("point", "order"), np.stack([np.exp(-order), 0.1 + 0 * order])),
        "half_order_amplitude": (("point",), [1e-16, 0.02]),
        "contact_loss_share": (("point",), [-1e-13, 0.8]),
        "back_impacts": (("point",), [0.0, 0.25]),
        "status": (("point",), [0, 0]),
    }
    base = {"damping_ratio": 0.15, "frequency_ratio": 1.2, "stiffness_amplitude": 0.3,
            "mean_force": 0.017, "force_amplitude": -1.16, "half_backlash_ratio": 1.0,
            "thermal_stiffness_ratio": 0.0}  # fmt: skip
    variables |= {name: (("point",), [value, value]) for name, value in base.items()}
    data = label(variables, None, {"bin_width_orders": 0.125, "title": "Table 4.2: damping"})
    for name in (
        "section_displacement",
        "section_velocity",
        "line_amplitude",
        "half_order_amplitude",
    ):
        data[name].attrs["units"] = "1"
    data["peak_to_peak_displacement"] = (("point",), [2.0, 2.2], {"units": "1"})
    words = {
        "row": ["zeta", "zeta"], "parameter": [parameter] * 2, "value_unit": [unit] * 2,
        "label": ["period-1", "chaotic"], "label_reason": ["multiplier -0.94", "exponent 0.05 > 0"],
        "expected": ["period-1 or undecided", "period-4"],
    }  # fmt: skip
    for name, texts in words.items():
        data[name] = (("point",), texts)
    data["value"] = (("point",), list(swept))
    data["phase"] = (("sample",), phase, {"units": "1"})
    return data
