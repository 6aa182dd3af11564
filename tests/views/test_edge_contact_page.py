"""What a reader of the loaded contact's page and tables is told of tip corners under load."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from thermogear.case.case import GearCase, load_example
from thermogear.study.contact import loaded_survey
from thermogear.views.drawing import draw
from thermogear.views.pages.contact import along_path
from thermogear.views.write import save


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    case = load_example("rig", ("temperatures.row=[]",))
    assert isinstance(case, GearCase)
    out = tmp_path_factory.mktemp("contact")
    save(loaded_survey(case, (100.0,)), out)
    return out


@pytest.fixture(scope="module")
def data(folder: Path) -> xr.Dataset:
    with xr.open_datatree(folder / "contact.nc", engine="h5netcdf") as tree:
        return tree["contact"].to_dataset().load()


def test_a_missing_pressure_of_a_table_stands_beside_its_reason(folder: Path) -> None:
    table = folder / "contact_contact_by_load_mesh_phase_pair_temperature.csv"
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    seen = {row["edge_contact"] for row in rows}
    assert seen == {"no_edge_contact", "wheel_tip_corner", "pinion_tip_corner"}
    for row in rows:
        assert (row["contact_pressure [Pa]"] == "") == (row["edge_contact"] != "no_edge_contact")


def test_the_page_says_where_and_how_long_corners_carry(folder: Path, data: xr.Dataset) -> None:
    page = (folder / "contact.html").read_text(encoding="utf-8")
    assert re.search(r"pressure [^<]*\[MPa\]", page)
    flags = data["edge_contact"].sel(temperature="hot").isel(load=0).values
    early, late = (100 * np.mean((flags == corner).any(axis=-1)) for corner in (1, 2))
    rows = re.findall(r"<tr>.*?</tr>", page, re.DOTALL)
    for gear, part in (("wheel", early), ("pinion", late)):
        (row,) = (one for one in rows if f">{gear}<" in one and ">hot<" in one)
        assert f">{part:.1f}<" in row
    assert re.search(r"contact: \w", page)


def test_the_picture_stops_the_pressure_and_shades_the_corners(data: xr.Dataset) -> None:
    figure = draw(along_path(data, {}))
    shares, pressures = figure.axes
    s, flags = data["pair_position"].values, data["edge_contact"].values
    for axis in (shares, pressures):
        early, late = sorted(patch.get_x() for patch in axis.patches)
        assert early == pytest.approx(1e3 * s[(flags == 1).any(axis=(0, 1))].min())
        assert late == pytest.approx(1e3 * s[(flags == 2).any(axis=(0, 1))].min())
    assert all(np.isnan(line.get_ydata()).any() for line in pressures.lines)
    assert not any(np.isnan(line.get_ydata()).any() for line in shares.lines)
