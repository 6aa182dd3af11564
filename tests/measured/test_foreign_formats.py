"""Records that other libraries write are read back as they were: TDMS, UFF 58, MDF 4."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import asammdf
import numpy as np
import pytest
import pyuff
from nptdms import ChannelObject, TdmsWriter

from thermogear import read_record
from thermogear.base.errors import InputError

RATE = 25_600.0
COUNT = 5000
TIME = np.arange(COUNT) / RATE
LINE = np.sin(2.0 * np.pi * 416.667 * TIME)


def tdms(path: Path) -> None:
    marks = {"wf_increment": 1.0 / RATE, "unit_string": "m/s^2"}
    with TdmsWriter(str(path)) as writer:
        writer.write_segment([ChannelObject("rig", "a1", LINE, properties=marks)])


def uff(path: Path, name: str = "a1", unit: str = "m/s^2") -> None:
    axes = ("abscissa", "ordinate", "orddenom", "z_axis")
    record: dict[str, object] = {"type": 58, "binary": 0, "data": LINE, "x": TIME}
    record |= {f"id{i}": name if i == 1 else "" for i in range(1, 6)}
    record |= {"func_type": 1, "func_id": 0, "ver_num": 0, "load_case_id": 0}
    record |= {"rsp_ent_name": name, "rsp_node": 1, "rsp_dir": 1}
    record |= {"ref_ent_name": "NONE", "ref_node": 1, "ref_dir": 1}
    record |= {"ord_data_type": 4, "num_pts": COUNT, "abscissa_spacing": 1}
    record |= {"abscissa_min": 0.0, "abscissa_inc": 1.0 / RATE, "z_axis_value": 0}
    for axis in axes:
        record |= {f"{axis}_{part}_unit_exp": 0 for part in ("len", "force", "temp")}
        record |= {f"{axis}_spec_data_type": 0}
        record |= {f"{axis}_axis_lab": "NONE", f"{axis}_axis_units_lab": "NONE"}
    record |= {"abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s"}
    record |= {"ordinate_spec_data_type": 12, "ordinate_axis_units_lab": unit}
    pyuff.UFF(str(path)).write_sets(record, "overwrite")


def mdf(path: Path) -> None:
    file = asammdf.MDF()
    file.append([asammdf.Signal(LINE, TIME, name="a1", unit="m/s^2")])
    file.save(path, overwrite=True)
    file.close()


@pytest.mark.parametrize(("write", "name"), [(tdms, "a.tdms"), (uff, "a.uff"), (mdf, "a.mf4")])
def test_samples_rate_and_unit_come_back(
    write: Callable[[Path], None], name: str, tmp_path: Path
) -> None:
    write(tmp_path / name)
    record = read_record(tmp_path / name)
    assert record.rate == pytest.approx(RATE, rel=1e-9)
    assert record.channels[0].unit == "m/s^2"
    np.testing.assert_allclose(record.channels[0].values(), LINE, atol=1e-11)


def test_an_mdf_file_that_was_never_closed_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its reader copies such a file to the folder of temporary files, and fails over it there."""
    path, place = tmp_path / "a.mf4", tmp_path / "temporary"
    mdf(path)
    data = bytearray(path.read_bytes())
    data[60:62] = (1).to_bytes(2, "little")
    data[64:104] = bytes(40)
    path.write_bytes(data)
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    for name in ("TMPDIR", "TEMP", "TMP"):
        monkeypatch.setenv(name, str(place))
    with pytest.raises(InputError, match="MDF"):
        read_record(path)
    assert list(place.iterdir()) == []
