"""``make trial NAME=friction_evidence``: what is measured, and that the page is the script's."""

from __future__ import annotations

import numpy as np
import pytest
from scripts import ROOT, script

from thermogear import MeshModel
from thermogear.heat.friction import LAWS


def test_losses_from_printed_errors_agree_among_themselves_and_with_the_text() -> None:
    evidence = script("trials/friction_evidence")
    errors = {int(n): rest for n, *rest in evidence.read()["source"]["petry-johnson"]["errors"]}
    shares = {n: evidence.loss_from_errors(rest) for n, rest in errors.items()}
    for low, high in shares.values():
        assert 0.0 < low < high < 1.4 * low
    low, high = shares[6000]
    # the text: 0.2 kW are 43.02 %; 413 N m at 6000 rpm are 259.5 kW
    printed = 100.0 * 0.2 / 0.4302 / (413.0 * 6000.0 * np.pi / 30e3)
    assert low < printed < high
    with pytest.raises(ValueError, match="contradict each other"):
        evidence.loss_from_errors([(10.0, 0.05), (20.0, 0.02)])


def test_cases_are_those_of_their_sources() -> None:
    evidence = script("trials/friction_evidence")
    every = evidence.cases(evidence.read())
    assert len(every) == 14
    loops = [one for one in every if one.kind == "temperature"]
    assert len(loops) == 8
    for one in loops:  # theta_M = 80 + 0.23 T1, oil 80 + 0.09 T1
        assert one.middle == pytest.approx(80.0 + 0.23 * one.torque, abs=0.06)
        assert one.oil_temperature - 273.15 == pytest.approx(80.0 + 0.09 * one.torque, abs=0.06)
    relieved = next(one for one in every if one.kind == "friction")
    assert relieved.measured == (0.065, 0.065)
    pair = evidence.gear_pair(evidence.read()["gears"]["petry-johnson"])
    # table 3.7: base diameter 81.89, root 85.90, thickness at the pitch circle 2.925 mm
    assert 2e3 * pair.pinion.base_radius == pytest.approx(81.89, abs=0.1)
    assert 2e3 * pair.pinion.root_radius == pytest.approx(85.90, abs=0.1)
    pitch = pair.pinion.pitch_radius
    thickness = 2e3 * pitch * float(pair.pinion.half_thickness_angle(pitch))
    assert thickness == pytest.approx(2.925, abs=2e-3)


def test_the_committed_page_is_that_of_the_script() -> None:
    """Losses and friction by the default are computed anew; where they differ, make it again."""
    evidence = script("trials/friction_evidence")
    table = evidence.read()
    every = evidence.cases(table)
    text = evidence.PAGE.read_text("utf-8")
    default = MeshModel.consistent().friction
    quick = [one for one in every if one.kind != "temperature"]
    for row in evidence.rows(table, quick, default):
        assert evidence.line(row) in text, "run make trial NAME=friction_evidence"
    lines = text.splitlines()
    for law in LAWS:
        assert sum(line.startswith(f"| {law} | ") for line in lines) == 1 + len(every)
    for one in every:
        assert evidence.measured_words(one) in text
    assert ROOT in evidence.PAGE.parents
    assert evidence.PICTURE.name in text
    assert "<svg" in evidence.PICTURE.read_text("utf-8")
