"""The temperature dial of a run: each temperature is a case of its own."""

from __future__ import annotations

import numpy as np
import pytest

import thermogear as tg
from own_pair import OWN_PAIR
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.thermal_state import HOT, ThermalState
from thermogear.study.dial import COUNT, dial, stops

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")
SEED = 7


def cases() -> list[tuple[str, GearCase]]:
    """An own pair with computed heat, ready-made ones with given heat, steel and plastic."""
    names = ("loaded-27-35", "pom-steel", "rig")
    return [("own", gear_case(load_case(OWN_PAIR)))] + [(n, gear_case(load_case(n))) for n in names]


@pytest.mark.parametrize(("name", "case"), cases(), ids=[n for n, _ in cases()])
def test_every_stop_is_the_cycle_of_its_temperature(name: str, case: GearCase) -> None:
    model = case.models[0]
    data = dial(case, HOT.cycle(case, model))
    assert data is not None
    worst = 0.0
    for place, kelvin in enumerate(data["gear_temperature"].values):
        alone = ThermalState.at(float(kelvin)).cycle(case, model).isel(operating=0)
        one = data.isel(gear_temperature=place)
        for figure in ("mesh_stiffness", "half_backlash", "half_backlash_curve", "mean_stiffness"):
            size = float(np.abs(data[figure]).max())
            worst = max(
                worst, float(np.abs(one[figure].values - alone[figure].values).max()) / size
            )
        jammed = float(alone["least_half_backlash"]) <= 0.0
        assert (STATUS[int(one["status"])] == "jammed") is jammed
        if jammed:
            assert np.isnan(one["displacement"]).all()
    print(f"{name}: worst {worst:.1e} of size")
    assert worst < 1e-6 if case.computed else worst < 1e-12
    hot = float(np.ravel(case.operating_of(model).temperatures.pinion_addendum)[0])
    assert float(data["gear_temperature"][data.attrs["start"]]) == hot


def test_a_run_stores_the_dial_and_its_page_turns_it() -> None:
    result = tg.run(load_case(OWN_PAIR))
    assert result.groups["dial"].sizes["gear_temperature"] == COUNT
    shown = tg.pictures(result)["dial"].shown
    assert shown.dial is not None
    assert len(shown.dial.told) == len(shown.dial.values) == COUNT
    panels = {tuple(len(row) for row in shown.dial.make(i).panels) for i in range(COUNT)}
    assert panels == {(3,)}


def test_stops_rise_hold_the_hot_gears_and_stay_within_a_case_file() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(300):
        reference, hot = rng.uniform(230.0, 300.0), rng.uniform(235.0, 850.0)
        jam = float(rng.choice([np.nan, rng.uniform(200.0, 900.0)]))
        row = stops(reference=reference, hot=hot, jam=jam)
        assert (np.diff(row) > 0.0).all()
        assert hot in row
        assert row[0] >= -70.0 + ZERO_CELSIUS
        assert row[-1] <= 600.0 + ZERO_CELSIUS
        assert 2 <= row.size <= COUNT
        if hot + 40.0 < jam < min(hot + 150.0, 850.0):
            assert row[-1] > jam - 0.5
