"""A picture by every function that a run's page does not call, from small made-up datasets."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from thermogear.base.display import KELVIN
from thermogear.base.vocabulary import STATUS
from thermogear.views.gears import DrawnState, GearDrawing
from thermogear.views.pages import contact as loaded
from thermogear.views.pages import (
    detect,
    diagnosis,
    measured,
    relief,
    rig_trains,
    train_motion,
    turn,
    warm_up,
    waterfall,
)
from thermogear.views.pages import temperature as thermal_map
from thermogear.views.pages.answers import series_picture, speeds_picture
from thermogear.views.pages.basin_shares import shares_picture
from thermogear.views.picture import Picture
from thermogear.views.plots import (
    claims,
    flanks,
    gears,
    laws,
    live,
    lost_contact,
    one_motion,
    shafts,
    sweeps,
)
from thermogear.views.plots.one_motion import plane_picture

SIZES = {
    "direction": 2, "start": 1, "damping_ratio": 5, "frequency": 4, "section": 3, "branch": 1,
    "branch_point": 4, "bifurcation": 2, "x": 4, "v": 5, "attractor_number": 2, "point": 2,
    "state": 2, "pinion_speed": 5, "order": 6, "sample": 16, "multiplier": 2, "batch": 8, "leg": 6,
    "event": 1, "load": 3, "speed": 4, "part": 2, "operating": 2, "law": 2, "path_position": 9,
    "regime_name": 3, "temperature": 2, "mesh_phase": 8, "pair": 2, "temperature_difference": 3,
    "pair_kind": 2, "speeds": 4, "torques": 3, "node": 2, "time": 12, "piece": 2, "sensor": 2,
    "channel": 1, "thermal": 2, "torque": 2, "row": 2, "heat": 1, "flip": 2,
    "output": 2, "input": 3, "gear_temperature": 6, "gears.pinion.face_width": 3, "bearing": 2,
    "pinion_position": 12, "wheel_position": 12, "mode": 5, "stiffness_level": 3, "line": 3,
    "source": 3, "response_speed": 12, "map_column": 5, "slice": 3, "step": 6, "record": 4,
    "quantile": 3, "damping": 3, "relief": 3, "gear": 2, "place": 3,
    "question": 2, "pinion_torque": 1, "variant": 5, "signal": 1, "sight": 3,
}  # fmt: skip
S = "path_position"


def rising(*dims: str, low: float = 1.0, high: float = 2.0) -> tuple[tuple[str, ...], np.ndarray]:
    """Numbers from ``low`` to ``high`` over the axes ``dims``."""
    shape = [SIZES[dim] for dim in dims]
    return dims, np.linspace(low, high, int(np.prod(shape))).reshape(shape)


def made(dims: str, *names: str, **others: object) -> xr.Dataset:
    """A dataset of rising numbers over the axes ``dims`` under each of ``names``."""
    return xr.Dataset({name: rising(*dims.split()) for name in names} | others)


def of_sweeps() -> dict[str, Picture]:
    branches = made("branch branch_point", "branch_value", "branch_x", "branch_multiplier")
    two = ("bifurcation", np.array([0, 1]))
    events = made("bifurcation", "bifurcation_value", "bifurcation_x", bifurcation_kind=two)
    events["bifurcation_state"] = two
    diagram = made("direction start damping_ratio", "lyapunov").assign(
        section_x=rising("direction", "start", "damping_ratio", "section"),
        damping_ratio=rising("damping_ratio"),
    )
    codes = {"label": np.array([1, 1, 2, 3])[:3], "period": np.array([1, 9, 0]),
             "status": np.zeros(3, int), "drive_share": np.array([1.0, 0.9, np.nan, 0.8]),
             "back_share": np.array([0.0, 0.0, np.nan, 0.1])}  # fmt: skip
    grid = xr.Dataset(
        {name: (("damping_ratio", "frequency"), np.resize(values, (5, 4)))
         for name, values in codes.items()},
        {"damping_ratio": rising("damping_ratio")[1], "frequency": rising("frequency")[1]},
    )  # fmt: skip
    names = {"names": json.dumps(["left", "right"])}
    lost = grid.assign(
        lost_contact=(grid["label"].dims, np.resize([0, 1, 3, 4, 13, -1], (5, 4)))
    ).assign_coords(bearing=("bearing", np.arange(2), names))  # fmt: skip
    forces = (
        made("direction start damping_ratio", "greatest_mesh_force", "drive_free_share")
        .assign(
            greatest_bearing_force=rising("direction", "start", "damping_ratio", "bearing"),
            bearing_free_share=rising("direction", "start", "damping_ratio", "bearing", high=1.5),
        )
        .assign_coords(damping_ratio=rising("damping_ratio"), bearing=lost["bearing"])
    )
    basins = made("attractor_number point", "attractor_x", "attractor_v").assign(
        x=rising("x"), v=rising("v"), fraction=rising("attractor_number"),
        attractor=(("x", "v"), np.resize([np.nan, np.nan, 0, 1], (4, 5))),
        status=(("x", "v"), np.resize([3, 2, 0, 0], (4, 5))),
        attractor_period=("attractor_number", np.array([1, 0])),
    )  # fmt: skip
    each = ("damping_ratio", "motion")
    part = np.array([[0.7, 0.2], [0.5, 0.3]])
    shares = xr.Dataset(
        {
            **{f"motion_share{end}": (each, part + more)
               for end, more in (("", 0.0), ("_low", -0.05), ("_high", 0.05))},
            "least_displacement": (each, 1e-6 * part), "least_velocity": (each, 1e-3 * part),
            "plane_scale": ("damping_ratio", [1e-6, 1e-6]),
            "undecided_share": ("damping_ratio", [0.1, 0.0]),
            "diverged_share": ("damping_ratio", [0.0, 0.2]),
        },
        {"damping_ratio": [0.1, 0.2]}, {"parameter": "damping_ratio"},
    )  # fmt: skip
    run = "state direction pinion_speed"
    run_up = made(run, "dte_peak_to_peak", "mesh_force_max", "dynamic_factor").assign(
        pinion_speed=rising("pinion_speed"), order=rising("order"),
        dte_line=rising(*run.split(), "order"), gear_temperature=rising("state", high=400.0),
    )  # fmt: skip
    band = rising("quantile", "damping", "pinion_speed")[1]
    of_parts = made("state damping pinion_speed", "series_parting_share").assign(
        series_dynamic_factor=(
            ("state", "share", "damping", "pinion_speed"), np.resize(band, (2, 4, *band.shape[1:]))
        ),
        damping_ratio=rising("damping"),
    )  # fmt: skip
    width = "gears.pinion.face_width"
    line = made(width, "dte_peak_to_peak", "dynamic_factor", "label", "status")
    line = line.assign_coords({width: (width, rising(width)[1], {"units": "m"})})
    columns = [
        f"series_{figure}_{name}" for figure in ("dynamic_factor", "static_error")
        for name in ("low", "median", "high")
    ]  # fmt: skip
    lines = line.merge(made(width, "static_error", "series_parts", *columns))
    both = grid.assign(dynamic_factor=rising("damping_ratio", "frequency"))
    bad = made("damping_ratio frequency", "series_dynamic_factor_bad", "series_parts")
    look = made("pinion_speed", "dynamic_factor").assign(
        pinion_speed=rising("pinion_speed"),
        contact_loss_share=("pinion_speed", np.array([0.0, 0.0, 0.1, 0.2, 0.0])),
    ).assign_attrs(own_speeds=[1.5])  # fmt: skip
    series = made("operating quantile damping pinion_speed", "dynamic_factor").assign(
        pinion_speed=rising("pinion_speed"), damping_ratio=rising("damping"),
        parting_share=rising("operating", "damping", "pinion_speed"),
        own_dynamic_factor=rising("operating", "damping", "part"), own_speed=rising("operating"),
    ).assign_attrs(gravest=1)  # fmt: skip
    diagram = diagram.merge(branches).merge(events).assign_attrs(parameter="damping_ratio")
    return {
        "diagram": sweeps.orbit_diagram_picture(diagram),
        "map": lost_contact.map_picture(grid),
        "lost-contact": lost_contact.lost_contact_picture(lost),
        "train-forces": lost_contact.forces_picture(forces.assign_attrs(parameter="damping_ratio")),
        "basins": sweeps.basins_picture(basins),
        "basin-shares": shares_picture(shares),
        "runup": sweeps.run_up_picture(run_up.merge(events)),
        "waterfall": sweeps.waterfall_picture(run_up),
        "sweep-1": sweeps.sweep_picture(line),
        "sweep-2": sweeps.sweep_picture(both),
        "runup-series": sweeps.run_up_picture(run_up.merge(of_parts)),
        "sweep-series-1": sweeps.sweep_picture(lines),
        "sweep-series-2": sweeps.sweep_picture(both.merge(bad)),
        "look": speeds_picture(look),
        "series": series_picture(series),
    }


def of_orbits() -> dict[str, Picture]:
    orbit = made("sample", "time", "displacement", "velocity").assign(
        orbit_period=1.0, half_backlash=1.5, order=rising("order", high=9.0),
        section_displacement=rising("section"), section_velocity=rising("section"),
        line_amplitude=rising("order"), line_frequency=rising("order", high=900.0),
        multiplier_real=rising("multiplier", low=0.5), multiplier_imag=rising("multiplier"),
    )  # fmt: skip
    branch = made("leg", "value", "section_x", stable=("leg", np.arange(6) < 3)).assign(
        event_value=rising("event", low=1.5), event_x=rising("event"),
        event_kind=("event", ["period doubling"]),
    ).assign_attrs(parameter="frequency", period=2, row="omega", heat="without heat")  # fmt: skip
    return {
        "orbit": one_motion.orbit_picture(orbit),
        "lyapunov": one_motion.lyapunov_picture(made("batch", "lyapunov_batch")),
        "branch": one_motion.branch_picture([branch], "a branch"),
    }


def two_gears(teeth: int = 12) -> GearDrawing:
    """Two gears of one shape, trapezia for teeth."""
    angle = np.array([-1.0, -0.7, -0.3, 0.3, 0.7, 1.0]) * np.pi / teeth
    radius = np.array([8.5, 8.5, 11.0, 11.0, 8.5, 8.5])
    shape = radius * np.exp(1j * angle)
    states = tuple(
        DrawnState(
            name=name,
            outlines=(grown * shape, grown * shape),
            centre_distance=20.0 * grown,
            set_back=0.05,
            lag=np.array([0.0, 0.01]),
            share=np.array([[0.0, 1.0], [0.4, 0.6]]),
            drive_gap=np.array([[np.nan, 0.0], [0.01, 0.0]]),
            back_gap=np.array([[0.2, 0.3], [np.nan, 0.2]]),
        )
        for name, grown in (("undeformed", 1.0), ("hot", 1.001))
    )
    circles = {"base": 9.4, "pitch": 10.0, "tip": 11.0, "root": 8.5, "bore": 4.0}
    return GearDrawing(
        words="100 rpm, 1 N m",
        module=1.5,
        teeth=(teeth, teeth),
        start=(0.0, np.pi),
        circles=(circles, circles),
        tight=(shape, shape),
        states=states,
        phase=np.array([0.0, 0.25]),
        contact=np.array([[complex(np.nan, np.nan), 10.0 + 1j], [9.0 - 2j, 10.5 + 2j]]),
        centre_distance=20.0,
        pressure_angle=0.35,
        path={"A": 9.0 - 2.5j, "E": 11.0 + 2.5j},
        factor=2.0,
    )


def of_detection() -> dict[str, Picture]:
    over = "question state pinion_speed pinion_torque variant signal sight"
    shares = made(over, "detected_share", "detected_low", "detected_high").assign(
        relative_size=rising("variant", low=0.0, high=1.0),
        variant=["none, pinion", "none, wheel", "crack 1", "crack 2", "crack 4"],
        question=["same machine", "another machine"], sight=["fm4", "any", "tooth"],
        state=["hot", "undeformed"], fault=["crack"],
    ).assign_attrs(families=[3])  # fmt: skip
    return {"detect-shares": detect.heat_table(shares), "detect-sizes": detect.over_size(shares)}


def of_surveys() -> dict[str, Picture]:
    points = json.dumps({"A": 1.0, "C": 1.5, "E": 2.0})
    chart = made("sample", "diameter", "drive_fit", "drive_acting").assign(
        trace_deviation=rising("pair", "sample"), trace_flank=("pair", ["drive", "drive"])
    ).assign_attrs(evaluated_from=1.2, evaluated_to=1.8, pitch_diameter=1.5)  # fmt: skip
    friction = made(f"operating law {S}", "friction_coefficient").assign(
        outside_range=(("operating", "law", S), np.resize([0, 0, 1], (2, 2, 9))),
        regime=(("operating", S), np.resize([0, 1], (2, 9))), law=["one", "two"],
        regime_share=rising("operating", "regime_name"), film_parameter=rising("operating", S),
        regime_name=["boundary", "mixed", "elastohydrodynamic"], path_position=rising(S),
        pinion_speed=rising("operating"), pinion_torque=rising("operating"),
    ).assign_attrs(path_points=points)  # fmt: skip
    tooth = "temperature load mesh_phase pair"
    curves = ("tangent_stiffness", "secant_stiffness", "transmission_error")
    contact = made("temperature load mesh_phase", *curves).assign(
        load_share=rising(*tooth.split()), contact_pressure=rising(*tooth.split()),
        edge_contact=(tooth.split(), np.resize([0, 0, 1], (2, 3, 8, 2))),
        pair_position=rising("mesh_phase", "pair"), mesh_phase=rising("mesh_phase"),
        load=rising("load"), temperature=["undeformed", "hot"],
    )  # fmt: skip
    apart = made("temperature_difference load", "double_contact_length").assign(
        load=rising("load"), temperature_difference=rising("temperature_difference", low=-1.0)
    )
    pairs = made("pair_kind mesh_phase", "transmission_error", "tangent_stiffness").assign(
        mesh_phase=rising("mesh_phase"), load=rising("load"), pair_kind=["unrelieved", "relieved"],
        peak_to_peak_error=rising("pair_kind", "load"),
    )  # fmt: skip
    return {
        "flanks": flanks.traces(chart),
        "gears": gears.in_mesh(two_gears()),
        "laws": laws.laws(friction, 0, frozenset({"two"})),
        "film": laws.film(friction),
        "contact-phase": loaded.over_phase(contact),
        "contact-path": loaded.along_path(contact, json.loads(points)),
        "double-contact": loaded.double_contact(apart, 1.0, "double_contact_length"),
        "relief-error": relief.error(pairs),
        "relief-load": relief.over_load(pairs, 1.5),
        "relief-parts": relief.each_part(
            made("relief part", "ratio").assign(relief=["none", "a", "b"])
        ),
        "relief-profile": relief.profile(
            made("gear place", "roll_angle", "taken_off", "diameter").assign(
                gear=["pinion", "wheel"]
            )
        ),
        "thermal-map": thermal_map.thermal_map(closed_loop()),
        "thermal-line": thermal_map.thermal_map(closed_loop().isel(torques=[0])),
        "thermal-map-bare": thermal_map.thermal_map(closed_loop(np.nan)),
        **of_turn(),
        **of_warm_up(),
        **of_records(),
        **of_diagnosis(),
        **of_detection(),
    }


def of_turn() -> dict[str, Picture]:
    """Gears of 2 and 3 teeth over their turn of 6 mesh periods."""
    phase, order = np.arange(144) / 24, np.arange(1, 24) / 6
    error = 1e-6 * np.sin(2.0 * np.pi * phase) + 2e-6 * np.cos(np.pi * phase)
    errors = ("transmission_error", "unloaded_error")
    data = xr.Dataset(
        dict.fromkeys(errors, ("mesh_phase", error))
        | dict.fromkeys(("line_amplitude", "unloaded_line"), ("order", 1e-06 / order)),
        {"mesh_phase": phase, "order": order},
        {"mesh_periods": 6, "teeth": [2, 3], "first": [1, 1]},
    )
    teeth = {"gear": ["pinion"] * 2 + ["wheel"] * 3, "number": [1, 2, 1, 2, 3]}
    sizes = {"index_error": 1e-6 * np.arange(-2, 3), "contact_pressure": 1e9 * np.arange(1, 6)}
    rows = xr.Dataset({name: ("tooth", values) for name, values in (teeth | sizes).items()})
    return {
        "turn": turn.error_of_turn(data),
        "turn-orders": turn.orders_of_turn(data),
        "turn-teeth": turn.teeth_of_turn(rows),
    }


def of_diagnosis() -> dict[str, Picture]:
    """One turn of a shaft, its mesh harmonics, an envelope with a bearing's line, a cepstrum."""
    shaft = made("channel sample", "average", "difference").assign(
        mesh_amplitude=rising("slice", "channel", "sample"),
        mesh_phase_error=rising("slice", "channel", "sample"),
        teeth_turned=rising("sample", low=0.0, high=20.0),
        harmonic=("slice", [1, 2, 3]),
    )
    lines = made("sample", "envelope_amplitude", "envelope_floor").assign(
        envelope_order=rising("sample", low=0.0, high=8.0)
    )
    bearing = {"bearing": "6205", "part": "outer race", "shaft": "pinion", "order": 3.6}
    echoes = made("channel sample", "cepstrum").assign(turns=rising("sample", low=0.0, high=4.0))
    return {
        "diagnosis-turn": diagnosis.turn(shaft, "g"),
        "diagnosis-teeth": diagnosis.demodulated(shaft),
        "diagnosis-envelope": diagnosis.envelope(lines, [bearing]),
        "diagnosis-cepstrum": diagnosis.cepstrum(echoes),
    }


def of_records() -> dict[str, Picture]:
    """Orders of a run-up."""
    shown = made("row map_column", "map_reading").assign(
        map_order=rising("map_column"), map_speed=rising("row", low=100.0, high=300.0)
    )  # fmt: skip
    run = made("channel slice step", "slice_reading", "slice_reading_half_width").assign(
        slice_speed=rising("step", low=100.0, high=300.0)
    )
    run = run.assign_coords(name=("slice", [f"order {k}" for k in range(run.sizes["slice"])]))
    return {
        "order-map": measured.order_map(shown, "g", "the first shaft"),
        "order-slices": measured.over_speed(run, 0, "g"),
    }


def closed_loop(margin: float = 1.0) -> xr.Dataset:
    status = np.zeros((4, 3), int)
    status[0, 0] = STATUS.index("not_converged")
    names = ("least_film_parameter", "greatest_flash", "least_half_backlash", "mean_friction",
             "jam_temperature")  # fmt: skip
    return made("speeds torques", *names).assign(
        status=(("speeds", "torques"), status), within_oil_range=(("speeds", "torques"), status),
        tempered=(("speeds", "torques"), status), pinion_speed=rising("speeds"),
        pinion_torque=rising("torques"), regime_share=rising("speeds", "torques", "regime_name"),
        scuffing_margin=(("speeds", "torques"), margin * np.linspace(-9.0, 99.0, 12).reshape(4, 3)),
        node_temperature=rising("node", "speeds", "torques"), node=["pinion_tooth", "oil"],
    )  # fmt: skip


def of_warm_up() -> dict[str, Picture]:
    time = rising("time", low=0.0, high=7200.0)
    data = made("time", "half_backlash", "greatest_flash", "least_film_parameter").assign(
        time=time, node=["pinion_tooth", "oil"], sensor=["ring", "infrared"],
        node_temperature=rising("node", "time"), sensor_temperature=rising("sensor", "time"),
        true_temperature=rising("sensor", "time"), mean_stiffness=rising("time"),
        jam_margin=("time", np.full(12, np.nan)),
    )  # fmt: skip
    steady = made("piece", "half_backlash", begin=("piece", np.array([0.0, 3600.0])))
    record = made("channel time", "measured", time=time).assign_coords(channel=["oil"])
    worst = {"time_s": 7000.0, "half_backlash_m": 1e-4}
    return {
        "course": warm_up.course(data, steady, record, worst, cold=1.0, logarithmic=True),
        "mesh": warm_up.mesh(data, worst, logarithmic=False),
        "sensors": warm_up.sensors(data, record, logarithmic=True),
    }


def of_claims() -> dict[str, Picture]:
    diagram = made("direction start damping_ratio section", "section_x").assign(
        damping_ratio=rising("damping_ratio"),
        lyapunov=rising("direction", "start", "damping_ratio"),
    ).assign_attrs(parameter="damping_ratio")  # fmt: skip
    given = made("thermal speed torque", "flash_mixed", "flash_dry").assign(
        speed=rising("speed"), torque=rising("torque"), thermal=["given", "balance"]
    )
    multiplier = made("row temperature", "multiplier").assign(
        temperature=rising("temperature", low=300.0, high=400.0), row=["thesis", "consistent"],
        flip=("row", np.array([350.0, np.nan])),
    )  # fmt: skip
    entry = made("row", "u_val", "pinion_speed").assign(
        quantity=("row", ["displacement", "frequency"]), model=["with heat", "without heat"],
        comparison_error=(("row", "model"), np.full((2, 2), 0.2)),
        printed=(("row", "model"), np.full((2, 2), "1.0")),
    )  # fmt: skip
    total = made("output input", "total", total_conf=rising("output", "input", low=0, high=0.1))
    total = total.assign(
        output_words=("output", ["growth", "flash"]), input_words=("input", ["a", "b", "c"])
    )
    return {
        "thesis-diagram": sweeps.over_each_other([diagram] * 2, ["without heat", "hot"]),
        "over-grid": claims.over_grid(given, "flash", "flash temperature [K]", KELVIN),
        "warming": claims.warming(multiplier),
        "experiment": claims.experiment(entry),
        "sensitivity": claims.sensitivity(total),
    }


def of_sampled_rigs() -> dict[str, Picture]:
    places, speeds = ["cap", "teeth"], np.array([100.0, 200.0, 300.0])
    spread = np.linspace(1e-7, 5e-5, 18).reshape(2, 3, 3)
    data = xr.Dataset(
        {
            "spread": (("place", "rig_speed", "quantile"), spread),
            "nearest": (("place", "train", "rig_speed"), spread),
            "printed": ("rig_speed", np.array([1e-5, 2e-5, 5e-5])),
            "place_words": ("place", ["on a cap", "of the teeth"]),
            "needed_factor": (("seen", "train"), np.array([[2.0, 5.0, 70.0], [3.0, 9.0, 40.0]])),
            "seen_words": ("seen", ["on a cap", "of the teeth"]),
            "rank": (("target", "input"), np.array([[0.8, -0.5, 0.0], [0.1, 0.3, -0.9]])),
            "rank_error": (("target", "input"), np.full((2, 3), 0.05)),
            "target_words": ("target", ["how far off", "largest"]),
            "input_words": ("input", ["face width", "torque", "error"]),
        },
        coords={"place": places, "seen": places, "rig_speed": speeds},
        attrs={"near": 1.5},
    )
    return {
        "rig-displacements": rig_trains.displacements(data),
    }


def of_planes() -> dict[str, Picture]:
    about = {"kind": "fold", "first": "frequency", "second": "damping_ratio", "period": 1}
    curve = made("point", "first", "second").assign(
        stable=("point", np.array([1, 0])), asked=("point", np.array([1, 1]))
    )
    return {"event-plane": plane_picture([curve.assign_attrs(about)])}


def of_moving_trains() -> dict[str, Picture]:
    heat, two = ["undeformed", "hot"], ["left", "right"]
    rng = np.random.default_rng(5)
    point, over = ("state", "operating"), ("state", "direction", "pinion_speed")
    phase, order = np.arange(32) / 16.0, np.arange(1, 9) / 2.0
    round_ = np.linspace(0.0, 2.0 * np.pi, 32)
    moved = xr.Dataset(
        {
            "mesh_force": ((*point, "sample"), rng.uniform(0.0, 3e3, (2, 1, 32))),
            "back_force": ((*point, "sample"), rng.uniform(0.0, 1e2, (2, 1, 32))),
            "bearing_force": ((*point, "bearing", "sample"), rng.uniform(1, 2, (2, 1, 2, 32))),
            "section_deflection": ((*point, "section"), rng.uniform(0.0, 1e-4, (2, 1, 5))),
            "section_rate": ((*point, "section"), rng.uniform(-1.0, 1.0, (2, 1, 5))),
            "bearing_force_line": (
                (*point, "bearing", "line_order"), rng.uniform(0.1, 50.0, (2, 1, 2, 8)),
            ),
            "housing_line": ((*point, "line_order"), rng.uniform(0.01, 5.0, (2, 1, 8))),
            "mesh_force_line": ((*point, "line_order"), rng.uniform(0.01, 5.0, (2, 1, 8))),
            "mean_bearing_force": ((*point, "bearing"), rng.uniform(1.0, 2.0, (2, 1, 2))),
            "mean_bearing_load": ((*point, "bearing", "axis"), rng.normal(size=(2, 1, 2, 2))),
            "radial_internal_clearance": (
                (*point, "bearing"), [[[10e-6, np.nan]], [[-4e-6, np.nan]]],
            ),
            "journal_path": (
                (*point, "bearing", "axis", "sample"), rng.normal(0.0, 1e-5, (2, 1, 2, 2, 32)),
            ),
            "label": (point, [["period-1"], ["quasi-periodic"]]),
            "torus_deflection": ((*point, "angle"), np.full((2, 1, 32), np.cos(round_))),
            "torus_rate": ((*point, "angle"), np.full((2, 1, 32), np.sin(round_))),
            "second_frequency": (point, [[np.nan], [0.3819]]),
            "mesh_frequency": ("operating", [800.0]),
        },
        {"state": heat, "bearing": two, "phase": ("sample", phase), "line_order": order},
    )  # fmt: skip
    swept = xr.Dataset(
        {
            name: (over, rng.uniform(1.0, 9.0, (2, 2, 6)))
            for name in ("mesh_force_rms", "housing_rms", "contact_loss_share")
        }
        | {
            "bearing_force_rms": ((*over, "bearing"), rng.uniform(1.0, 9.0, (2, 2, 6, 2))),
            "bearing_force_line": (
                (*over, "bearing", "order"), rng.uniform(0.1, 9.0, (2, 2, 6, 2, 8)),
            ),
            "housing_line": ((*over, "order"), rng.uniform(0.1, 9.0, (2, 2, 6, 8))),
        },
        {"pinion_speed": np.linspace(100.0, 300.0, 6), "order": order},
        {
            "state_names": json.dumps(heat),
            "critical": json.dumps([[], [{"speed": 150.0, "force": 10.0}]]),
        },
    )  # fmt: skip
    return {
        "train-moving": train_motion.four_panels(moved, 0),
        "train-orbits": train_motion.bearing_orbits(moved, 0),
        "train-forces": train_motion.bearing_force_time(moved, 0),
        "train-bearing-orders": train_motion.bearing_force_order(moved, 0),
        "train-torus": train_motion.torus_section(moved, 0),
        "train-heard": train_motion.sound(moved, 0),
        "train-over-speed": waterfall.over_speed(swept),
        "train-orders": waterfall.lines(swept, 0),
        "train-sound": waterfall.sound(swept, 1),
    }


def of_shafts() -> dict[str, Picture]:
    heat, two = {"state": ["undeformed", "hot"]}, ["left", "right"]
    rings = made(
        "state operating bearing", "bearing_load",
        radial_internal_clearance=rising("state", "operating", "bearing", low=-1e-6, high=5e-6),
    ).assign_coords(heat | {"bearing": two})  # fmt: skip
    lines = (
        made("state operating pinion_position", "pinion_x", "pinion_y")
        .merge(made("state operating wheel_position", "wheel_x", "wheel_y"))
        .assign_coords(
            heat | {"pinion_position": np.arange(12.0), "wheel_position": np.arange(12.0)}
        )
    )
    table = made("state mode part", "energy_share").assign_coords(
        heat | {"part": ["mesh", "bearing"]}
    )
    count = table.sizes["mode"]
    table = table.assign(natural_frequency=rising("state", "mode", low=500.0, high=9e3))
    table = table.assign_coords(mode=np.arange(1, count + 1))
    shapes = xr.merge(
        made(f"state mode {s}_position", *(f"{s}_{c}_real" for c in ("x", "y", "twist")))
        .assign_coords({f"{s}_position": np.arange(12.0)})
        for s in ("pinion", "wheel")
    ).assign_coords(heat)  # fmt: skip
    curves = made("state stiffness_level pinion_speed mode", "natural_frequency").assign_coords(
        heat | {"pinion_speed": rising("pinion_speed", low=1.0, high=300.0)[1]}
    )
    met = made(
        "state stiffness_level line mode", "critical_speed", "resonant_force", "lift_off_speed"
    ).assign_coords(
        heat | {"line": ["mesh", "shaft", "elements"], "order": ("line", [20.0, 1.0, 3.5])}
    )
    answer = made(
        "state source response_speed bearing", "bearing_force_x", "bearing_force_y"
    ).assign_coords(
        heat | {"bearing": two, "source": ["mesh", "one", "two"], "response_speed": np.arange(12.0)}
    )
    shaft = {
        "name": "pinion",
        "sections": [[-0.05, 0.02, 0.03, 0.01], [0.02, 0.08, 0.025, 0.0]],
        "gear": [0.02, 0.06],
        "bearings": [["left", -0.04], ["right", 0.07]],
        "discs": [["flange", 0.06]],
        "end": ["motor", -0.05],
    }
    both = [shaft, shaft | {"name": "wheel", "discs": [], "end": None}]
    return {
        "train-sketch": shafts.sketch({"shafts": both, "centre_distance": 0.06}),
        "train-loads": shafts.loads(rings),
        "train-clearances": shafts.clearances(rings),
        "train-deflection": shafts.deflection(lines, 0),
        "train-modes": shafts.modes(table, shapes, 1),
        "train-energies": shafts.energies(table, 1),
        "train-campbell": shafts.campbell(curves, met, [100.0, 200.0]),
        **of_moving_trains(),
        "train-response": shafts.response(answer, "bearing_force", "force [N]"),
    }


def of_dials() -> dict[str, Picture]:
    two = ["undeformed", "hot"]
    mesh = made("state mesh_phase", "mesh_stiffness").assign(
        mean_stiffness=rising("state"), half_backlash=("state", np.array([1e-4, 5e-5]))
    )  # fmt: skip
    mesh = mesh.assign_coords(state=two, mesh_phase=rising("mesh_phase", low=0.0, high=0.9)[1])
    gap = xr.Dataset(
        {"half_backlash": rising("gear_temperature", low=1e-4, high=2e-5)},
        {"gear_temperature": rising("gear_temperature", low=293.0, high=460.0)},
    ).assign_attrs(jam_temperature=500.0, hot_temperature=413.0)  # fmt: skip
    speeds = np.linspace(100.0, 500.0, 12)
    lanes = ("state", "direction", "pinion_speed")
    leap = np.full((1, 2, 12, 3), np.nan)
    leap[0, 1, 4, 0] = 250.0
    ran = xr.Dataset(
        {"dte_peak_to_peak": (lanes, np.linspace(1e-6, 9e-5, 24).reshape(1, 2, 12)),
         "section_x": ((*lanes, "section"), np.linspace(0.5, 1.5, 96).reshape(1, 2, 12, 4)),
         "leap_kind": ((*lanes, "leap"), np.where(np.isnan(leap), np.nan, 0.0)),
         **{f"leap_{n}": ((*lanes, "leap"), leap * scale)
            for n, scale in (("fold", 1.0), ("before", 1e-7), ("after", 2e-7))}},
        {"pinion_speed": speeds},
    ).assign_attrs(preview=0, done=24, length=1e-4)  # fmt: skip
    t = np.arange(64) / 64.0
    orbit = xr.Dataset(
        {"time": ("sample", 1e-3 * t), "displacement": ("sample", 1e-5 * np.sin(6.28 * t)),
         "velocity": ("sample", 1e-2 * np.cos(6.28 * t)), "half_backlash": 5e-6,
         "section_displacement": ("section", np.array([0.0])),
         "section_velocity": ("section", np.array([1e-2])),
         "line_amplitude": ("order", np.geomspace(1e-5, 1e-9, 8))},
        {"order": np.arange(1, 9) / 1.0},
    )  # fmt: skip
    motions = {"the case's start": orbit, "running up": 0.5 * orbit}
    factor = 1.5 + 0.1 * np.arange(6)[:, None] + 0.01 * speeds
    pairs = xr.Dataset(
        {"dynamic_factor": (("part", "speed"), factor),
         "band": (("quantile", "speed"), factor[[0, 2, 5]]),
         "own_dynamic_factor": ("part", factor[:, 1])},
        {"pinion_speed": ("speed", speeds)},
    ).assign_attrs(parts=6, own_speed=float(speeds[1]), shown=3)  # fmt: skip
    return {
        "dial-stiffness": live.stiffness(mesh),
        "dial-series": live.series(pairs),
        "dial-gap": live.gap(gap),
        "dial-run-up": live.run_up({"hot": ran, "undeformed": ran}, 300.0),
        "dial-orbits": live.orbits(motions),
    }


def every() -> dict[str, Picture]:
    """All of them by name."""
    gears = of_sweeps() | of_orbits() | of_surveys() | of_shafts()
    return gears | of_claims() | of_sampled_rigs() | of_planes() | of_dials()
