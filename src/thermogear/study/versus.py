"""Case against case: stored results of several cases joined into one labelled Dataset.

Operating points are matched by speed and torque, bundles by name. What one case has and another has
not is NaN there, and said. Cases that are answered as a series are compared as series, and part by
part where they are of one seed.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.analysis.order_statistics import proportion
from thermogear.base.enclosed import folded, with_digests
from thermogear.base.errors import InputError
from thermogear.base.toml import overridden, tables, told
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS, attributes, label, told_labels
from thermogear.results.result import Notice, Result
from thermogear.study.series import Spread

MOST_CASES = 6
"""As many as colours that a reader tells apart."""
HIGHEST_ORDER = 8.5
"""Spectra are kept up to this order of the mesh frequency."""
OWN = "own bundle"
"""The bundle of cases that hold one each, under different names."""

FIGURES = (
    "half_backlash", "jam_temperature", "proportional_jam_temperature", "mean_stiffness",
    "thermal_stiffness_ratio", "natural_frequency", "frequency_ratio", "dte_peak_to_peak",
    "peak_to_peak_displacement", "greatest_flash_temperature",
)  # fmt: skip
CURVES = {
    "path_position": ("friction_coefficient", "flash_temperature", "deformation_sum"),
    "mesh_phase": ("half_backlash_curve", "mesh_stiffness"),
    "order": ("line_amplitude",),
}
GROUPS = ("mesh", "path", "motion")
PLACE = {"path_position": "path_place", "mesh_phase": "phase_place", "order": "line"}
"""The axis of a curve whose positions differ from case to case."""
LEAD = ("bundle", "state", "operating")

ALONG = dict.fromkeys(FIGURES, "") | {name: c for c, names in CURVES.items() for name in names}
"""Every figure and curve that is compared, and what it runs along."""
ABSENT = {"status": len(STATUS), "label": "", "present": 0}
"""What stands for texts and whole numbers where a case has no such point."""


LESS_IS_BETTER = ("dynamic_factor", "turn_error", "mesh_error")
"""What of the parts of a series is compared."""
ALIKE = 1e-9
"""Relative difference up to which two numbers of a part are the same: rounding."""


@dataclass(frozen=True, eq=False)
class Stored:
    """Stored results of one case; ``name`` tells cases of the same title apart."""

    name: str
    texts: Mapping[str, str]
    groups: Mapping[str, xr.Dataset]

    @property
    def bundles(self) -> list[str]:
        """The names of its bundles of choices."""
        return [str(name) for name in self.groups["mesh"]["bundle"].values]

    @property
    def states(self) -> list[str]:
        """Its states, undeformed first."""
        return [str(name) for name in self.groups["mesh"]["state"].values]

    def points(self) -> list[Hashable]:
        """What its operating points are matched by, each once."""
        mesh = self.groups["mesh"]
        columns = [_rounded(mesh[name]) for name in ("pinion_speed", "pinion_torque")]
        seen: Counter[Hashable] = Counter()
        found: list[Hashable] = []
        for key in zip(*columns, strict=True):
            seen[key] += 1
            found.append((*key, seen[key]))
        return found

    def table(self) -> dict[str, Any]:
        """The fields of its case file, what the command line put in their place included."""
        data = tables(f"case of {self.name}", str(self.texts.get("case", "")))
        changes = tuple((str(path), str(value)) for path, value in self.read("overrides", []))
        return flat(with_digests(overridden(data, changes)))

    def read(self, name: str, absent: Any) -> Any:
        """A JSON attribute, ``absent`` where it is not stored."""
        if name not in self.texts:
            return absent
        try:
            found = json.loads(self.texts[name])
        except ValueError as cause:
            found = cause
        if not isinstance(found, type(absent)):
            raise InputError(
                "results", self.name, why=f"attribute {name} is damaged", fix="run the case anew"
            )
        return found


def stored(result: Result, name: str = "case") -> Stored:
    """The results of a run, under a name that tells it from others of its title."""
    return Stored(name, {k: str(v) for k, v in result.attrs.items()}, result.groups)


def require_number(count: int) -> None:
    """Refuse fewer than two cases, and more than can be told apart."""
    if not 2 <= count <= MOST_CASES:
        noun = "case" if count == 1 else "cases"
        raise InputError(
            "versus",
            f"{count} {noun}",
            allowed=f"2..{MOST_CASES} cases",
            why="more colours are not told apart" if count > 1 else "a comparison takes two",
            fix="name directories of `thermogear run`, or case files",
        )


def require_gears(name: str, kind: str) -> None:
    """Refuse results of a case without gears."""
    if kind != "gear":
        raise InputError("versus", f"{name} ({kind})", allowed="cases of gear pairs")


def versus(cases: Sequence[Stored]) -> Result:
    """Two to six cases side by side: figures and curves with a leading axis ``case``.

    Figures have the axes (case, bundle, state, operating), curves one more: ``path_place``,
    ``phase_place`` or ``line``, whose positions are the variables ``path_position``,
    ``mesh_phase`` and ``order`` of each case. Where a case lacks a point, a bundle or a figure
    the numbers are NaN and texts empty; ``present`` (case, bundle, operating) tells. The
    attributes ``differences`` and ``notices`` hold JSON lists, and ``series`` that of
    :func:`of_series`.
    Raises InputError for a wrong number of cases, one without gears, and damaged results.
    """
    require_number(len(cases))
    for case in cases:
        require_gears(case.name, case.texts["kind"])
        _require_mesh(case)
    titles = unique_titles(cases)
    names = [case.bundles for case in cases]
    shared = set(names[0]).intersection(*names[1:])
    own = not shared and all(len(each) == 1 for each in names)
    bundles = [[OWN]] * len(cases) if own else names
    axes = {
        "case": titles,
        "bundle": _union(bundles),
        "state": _union([case.states for case in cases]),
        "operating": sorted(_union([case.points() for case in cases])),
    }
    data = _joined(cases, bundles, axes)
    return Result.of(
        "versus",
        " against ".join(titles) if len(titles) == 2 else " · ".join(titles),
        {"": data},
        _notices(cases, data, names if own else None),
        differences=differences(cases),
        series=list(of_series(cases, titles)),
        cases=[_text(case) for case in cases],
        path_points=[_path_points(case) for case in cases],
    )


# --- what the cases say -------------------------------------------------------------------


def flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables as dotted fields; places of a list of tables are numbered."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{prefix}{key}"
        if isinstance(value, Mapping):
            found |= flat(value, f"{name}.")
        elif isinstance(value, list) and value and all(isinstance(v, Mapping) for v in value):
            for place, one in enumerate(value):
                found |= flat(one, f"{name}[{place}].")
        else:
            found[name] = value
    return found


def differences(cases: Sequence[Stored]) -> list[dict[str, Any]]:
    """The fields of the case files that differ, a value for each case.

    Neither the title nor the reasons written for assumptions are a value. A field that a file
    leaves out shows what is taken in its place, where that is on record.
    """
    fields = [case.table() for case in cases]
    taken = [
        {str(row["field"]): str(row["value"]) for row in case.read("assumptions", [])}
        for case in cases
    ]
    found = []
    for name in _union([list(each) for each in fields]):
        if name == "title" or name.startswith("ours."):
            continue
        stated = [each.get(name) for each in fields]
        if any(value != stated[0] for value in stated[1:]):
            values = [
                each[name] if name in each
                else f"not stated: {ours[name]}" if name in ours
                else "not stated"
                for each, ours in zip(fields, taken, strict=True)
            ]  # fmt: skip
            found.append({"field": name, "values": values})
    return found


def of_series(cases: Sequence[Stored], titles: Sequence[str]) -> Iterator[dict[str, Any]]:
    """What cases answered as series have of their parts, a row for each case and operating point.

    SI, at the first damping ratio. ``dynamic_factor``, ``turn_error`` and ``mesh_error`` [m] with
    ``_low``, ``_middle``, ``_high`` and ``_bad`` are the quantiles of
    :class:`~thermogear.study.series.Spread`; of ``parts`` that move ``parting`` lose contact up to
    the own speed. Against the first case at this point, where both are of one seed, part by part:
    ``FIGURE_pairs`` differ, ``FIGURE_better`` of them have less of it here, of all parts a share
    between ``FIGURE_least_share`` and ``FIGURE_greatest_share`` with 95 %.
    """
    every = [_parts(case) for case in cases]
    for key in sorted(set().union(*every)):
        first: dict[str, Any] = {}
        for title, by_point in zip(titles, every, strict=True):
            if not (here := by_point.get(key)):
                continue
            known = np.isfinite(here["dynamic_factor"])
            row: dict[str, Any] = {
                "case": title, "point": _point_name((*key, 1)), "parts": int(known.sum()),
                "parting": int((here["onset"] <= key[0] * (1.0 + ALIKE))[known].sum()),
            }  # fmt: skip
            for name in LESS_IS_BETTER:
                for which, estimate in vars(Spread.of(here[name])).items():
                    row[f"{name}_{which}"] = estimate.value
                if first and first["seed"] == here["seed"]:
                    ours, theirs = zip(*zip(here[name], first[name], strict=False), strict=True)
                    gain = np.subtract(theirs, ours)
                    gain = gain[np.abs(gain) > ALIKE * np.abs(theirs)]
                    pairs, better = gain.size, int(np.count_nonzero(gain > 0.0))
                    row |= {f"{name}_pairs": pairs, f"{name}_better": better}
                    if pairs:
                        _, low, high = proportion(better, of=pairs)
                        row |= {f"{name}_least_share": low, f"{name}_greatest_share": high}
            first = first or here
            yield row


def _parts(case: Stored) -> dict[tuple[float, ...], dict[str, Any]]:
    """What of each part of a ``case`` is compared, (part,), by speed and torque."""
    data = case.groups.get("series")
    if data is None:
        return {}
    columns = [_rounded(data[name]) for name in ("own_speed", "pinion_torque")]
    keys = zip(*columns, strict=True)
    return {
        key: {
            "dynamic_factor": data["own_dynamic_factor"].values[place, 0],
            "turn_error": data["turn_error"].values[place],
            "mesh_error": data["mesh_error"].values[place],
            "onset": data["contact_loss_onset"].values[place, 0],
            "seed": int(data.attrs["seed"]),
        }
        for place, key in enumerate(keys)
    }


def unique_titles(cases: Sequence[Stored]) -> list[str]:
    """The titles on one line; equal ones with the names of their results, or numbered."""
    plain = [" ".join(str(c.texts.get("title", "")).split()) or c.name for c in cases]
    twice = Counter(plain)
    named = [
        f"{title} [{case.name}]" if twice[title] > 1 else title
        for title, case in zip(plain, cases, strict=True)
    ]
    found: list[str] = []
    for title in named:
        own, number = title, 1
        while own in found:
            number += 1
            own = f"{title} ({number})"
        found.append(own)
    return found


def _text(case: Stored) -> str:
    """The file as read, and below it what the command line put in its place."""
    text = folded(str(case.texts.get("case", ""))).rstrip()
    if "# on the command line:" in text:
        return text
    changes = [told(str(path), str(one)) for path, one in case.read("overrides", [])]
    return text + "".join(f"\n# on the command line: {change}" for change in changes)


def _path_points(case: Stored) -> dict[str, float]:
    path = case.groups.get("path")
    found = {} if path is None else json.loads(str(path.attrs.get("path_points", "{}")))
    return {str(name): float(value) for name, value in found.items()}


def _notices(
    cases: Sequence[Stored], data: xr.Dataset, own: Sequence[Sequence[str]] | None
) -> Iterator[Notice]:
    titles = [str(title) for title in data["case"].values]
    if own is not None:
        yield Notice.of("bundles_paired", bundles=[name[0] for name in own], cases=titles)
    for case, title in zip(cases, titles, strict=True):
        notices = map(Notice.stored, json.loads(case.texts.get("notices", "[]")))
        for notice in (each for each in notices if each.code.startswith("fault_")):
            yield replace(notice, text=f"{title}: {notice.text}")
    has = np.asarray(data["present"].values, dtype=bool)
    for c, title in enumerate(titles):
        for code, name, axis in (("bundles", "bundle", 2), ("operating", "point", 1)):
            there = np.asarray(has.any(axis=axis))
            alone = data[name].values[there[c] & (there.sum(axis=0) == 1)]
            if alone.size:
                yield Notice.of(f"{code}_in_one_case", case=title, names=alone)
    if not (has.sum(axis=0) > 1).any():
        yield Notice.of("nothing_side_by_side")
    versions = [str(case.texts.get("thermogear", "")) for case in cases]
    if len(set(versions)) > 1:
        yield Notice.of("versions_differ", cases=titles, versions=versions)


# --- joining ------------------------------------------------------------------------------


def _joined(
    cases: Sequence[Stored], bundles: Sequence[Sequence[str]], axes: Mapping[str, list[Any]]
) -> xr.Dataset:
    """Every case on the axes of all; what a case lacks is nan, "absent" or an empty text."""
    whole = xr.concat(
        [_alone(case, names, axes) for case, names in zip(cases, bundles, strict=True)],
        "case",
        data_vars="all",
        join="outer",
        fill_value=ABSENT,
        combine_attrs="override",
    )
    found: dict[str, Any] = {
        str(name): variable.variable for name, variable in whole.data_vars.items()
    }
    order = (*FIGURES, *(name for curve, names in CURVES.items() for name in (curve, *names)))
    # x is what a model does not take for the error: of gears the sum of both is compared
    own = "peak_to_peak_displacement" if "dte_peak_to_peak" in found else ""
    variables = {name: found[name] for name in order if name in found and name != own}
    variables |= {name: found[name] for name in ("status", "label", "present")}
    variables["status"].attrs |= {
        "flag_values": np.arange(len(STATUS) + 1, dtype=np.int8),
        "flag_meanings": " ".join((*STATUS, "absent")),
    }
    variables["label"] = variables["label"].astype(str)
    coordinates: dict[str, Any] = {name: axes[name] for name in ("case", "bundle", "state")}
    keys = axes["operating"]
    for place, name in enumerate(("pinion_speed", "pinion_torque")):
        coordinates[name] = ("operating", np.array([key[place] for key in keys]))
    coordinates["point"] = ("operating", [_point_name(key) for key in keys])
    return label(variables, coordinates)


def _alone(case: Stored, bundles: Sequence[str], axes: Mapping[str, list[Any]]) -> xr.Dataset:
    """One case, its axes numbered by their places on those of all."""
    own: tuple[Sequence[Any], ...] = (bundles, case.states, case.points())
    places = {a: [axes[a].index(one) for one in names] for a, names in zip(LEAD, own, strict=True)}
    sizes = tuple(map(len, places.values()))
    variables: dict[str, Any] = {
        "status": (LEAD, np.full(sizes, ABSENT["status"], np.int8)),
        "label": (LEAD, np.full(sizes, "", dtype=object), "", "kind of motion"),
        "present": (LEAD[::2], np.ones(sizes[::2], np.int8), "", "1 where the case has the point"),
    }
    for curve, place in PLACE.items():
        positions = _positions(case, curve)
        if positions.size:
            variables[curve] = xr.Variable(place, positions, attributes(curve))
            places[place] = list(range(positions.size))
    for data in _groups(case):
        for name in ("status", "label"):
            if name in data:
                values = told_labels(data) if name == "label" else data[name].values
                told = data.assign({name: (data[name].dims, values)})
                variables[name] = (LEAD, _laid(told, name), *variables[name][2:])
        for name, curve in ALONG.items():
            if name not in data or name in variables or (curve and curve not in variables):
                continue
            values = np.asarray(_laid(data, name, curve), dtype=float)
            dims: tuple[str, ...] = LEAD
            if curve:
                dims, values = (*LEAD, PLACE[curve]), values[..., : len(places[PLACE[curve]])]
            units = str(data[name].attrs.get("units", "1"))
            variables[name] = xr.Variable(dims, values, attributes(name) | {"units": units})
    return label(variables, {axis: (axis, numbers, "") for axis, numbers in places.items()})


def _laid(data: xr.Dataset, name: str, curve: str = "") -> NDArray[Any]:
    """``data[name]`` with the axes (bundle, state, operating[, curve]), whatever it lacks."""
    variable = data[name].variable
    lengths = {d: data.sizes.get(d, 1) for d in LEAD}
    if curve:
        lengths[curve] = data.sizes[curve]
    missing = [d for d in lengths if d not in variable.dims]
    values = variable.transpose(*[d for d in lengths if d in variable.dims]).values
    axes = tuple(list(lengths).index(d) for d in missing)
    return np.broadcast_to(np.expand_dims(values, axes), tuple(lengths.values()))


def _groups(case: Stored) -> list[xr.Dataset]:
    """The groups that figures are looked for in, in this order."""
    return [case.groups[name] for name in GROUPS if name in case.groups]


def _positions(case: Stored, curve: str) -> NDArray[np.float64]:
    """Where the curves along ``curve`` have their values; spectra end at the highest order."""
    for data in _groups(case):
        if curve in data.variables and any(n in data for n in CURVES[curve]):
            values = np.asarray(data[curve].values, dtype=float)
            return values[values <= HIGHEST_ORDER] if curve == "order" else values
    return np.zeros(0)


def _require_mesh(case: Stored) -> None:
    data = case.groups.get("mesh")
    if data is None or not {*LEAD[:2], "pinion_speed"} <= set(data.variables):
        raise InputError(
            "results", case.name, why="the group mesh is missing", fix="run the case anew"
        )


def _point_name(key: Sequence[Any]) -> str:
    again = "" if key[-1] == 1 else f" ({key[-1]})"
    return f"{key[0] / RPM:.6g} rpm, {key[1]:.6g} N m{again}"


def _rounded(values: xr.DataArray) -> list[float]:
    """Numbers that differ by rounding alone made equal."""
    return [float(f"{float(value):.9g}") for value in values.values]


def _union(lists: Sequence[Sequence[Any]]) -> list[Any]:
    """Every entry once, in the order of first appearance."""
    return list(dict.fromkeys(entry for each in lists for entry in each))
