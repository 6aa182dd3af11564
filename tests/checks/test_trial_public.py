"""The page of public records: what it says of one, and that it stays where there are none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scripts import script


@pytest.mark.slow
def test_a_page_stays_without_records_and_tells_what_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    trial = script("trials/public")
    page = tmp_path / "page.md"
    page.write_text("old", "utf-8")
    monkeypatch.setattr(trial, "PAGE", page)
    monkeypatch.setattr(trial, "ROOT", tmp_path)
    assert trial.main([str(tmp_path / "nowhere")]) == 0
    assert "stays as it is" in capsys.readouterr().out
    assert page.read_text("utf-8") == "old"
    assert trial.main(["--folder"]) == 2
    folder = tmp_path / "records"
    folder.mkdir()
    (folder / "README.md").write_text("# Rig\nTwenty | teeth.\n", "utf-8")
    (folder / "empty.csv").write_text("", "utf-8")
    t = np.arange(3000) / 5000.0
    x = np.cos(2 * np.pi * 400 * t) + 0.1 * np.random.default_rng(1).standard_normal(t.size)
    np.savetxt(folder / "a.csv", np.column_stack([t, x]), "%.7g", ",", header="time [s],a [g]",
               comments="")  # fmt: skip
    assert trial.main([str(folder)]) == 0
    text = page.read_text("utf-8")
    assert "> Twenty | teeth." in text
    assert "Refused: error: file: got empty.csv" in text
    assert "| rate | 5000 samples/s |" in text
    assert "400 Hz |" in text
    assert "| cost |" in text
