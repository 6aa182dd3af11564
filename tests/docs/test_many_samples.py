"""The page on many samples: what it tells people to write runs."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "many_samples.md"


def test_the_page_runs_as_written() -> None:
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert len(blocks) == 4
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    found, peak_to_peak = names["found"], names["peak_to_peak"]
    assert isinstance(found, dict)
    assert not found["status"].any()
    assert found["half_backlash"].shape == (256,)
    assert np.isfinite(np.asarray(peak_to_peak)).all()
