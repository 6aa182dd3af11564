"""The thesis's experiment once more: on drive trains that its rig could have been.

What 256 sampled drive trains show of the printed displacements, as counted before: the document
states too little of its rig for one train to stand for it. `make trial NAME=experiment` draws and
moves them and stores the answer.
"""

from __future__ import annotations

import json
from importlib.resources import files

from thermogear.base.arrays import Dataset

TABLE = "experiment.json"


def stored() -> Dataset:
    """The answer that comes with the package: shares, channels and rank correlations by name."""
    import xarray as xr

    text = (files("thermogear.thesis") / TABLE).read_text(encoding="utf-8")
    return xr.Dataset.from_dict(json.loads(text))
