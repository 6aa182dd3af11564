"""What benches of an old tree beside a new one share: the case, the turns, the medians.

Each piece of work runs in a process of its own, so that both trees start alike; the trees take
turns, and every turn has other numbers, so that no result of an earlier one is read.
"""

from __future__ import annotations

import os
import pickle
import statistics
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

TURNS = 5
CASE = """
import pickle, sys, time, warnings
import numpy as np
import thermogear as tg
warnings.simplefilter("ignore")
case = tg.load_case(\"\"\"
[gears]
module = "3 mm"
[gears.pinion]
teeth = 23
face_width = "30 mm"
[gears.wheel]
teeth = 41
face_width = "28 mm"
[oil]
name = "ISO VG 220"
[backlash]
value = "0.2 mm"
direction = "normal"
extent = "total"
[operating]
speed = "1700 rpm"
torque = "100 N m"
\"\"\")
"""
"""A pair of its own, before the work."""
TOLD = """
begun = time.process_time()
found = go(*map(float, sys.argv[1:]))
took = time.process_time() - begun
sys.stdout.buffer.write(pickle.dumps((took, told(found))))
"""
"""After the work has defined ``go`` of the given numbers and ``told`` of what it finds."""


def asked(tree: str, work: str, *given: float) -> tuple[float, Any]:
    """Processor time [s] of ``work`` in a ``tree``, and what it tells."""
    command = [sys.executable, "-c", CASE + work + TOLD, *map(str, given)]
    environment = {**os.environ, "PYTHONPATH": tree}
    raw = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    seconds, found = pickle.loads(raw.stdout)
    return seconds, found


def median(seconds: Sequence[float]) -> float:
    """Of the turns, in ms."""
    return 1e3 * statistics.median(seconds)


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """The greatest difference over the greatest number; infinite where other ones are finite."""
    known = np.isfinite(one)
    if not np.array_equal(known, np.isfinite(other)):
        return float("inf")
    first, second = one[known].astype(float), other[known].astype(float)
    scale = np.max(np.abs(first), initial=1e-300)
    return float(np.max(np.abs(first - second), initial=0.0) / scale)
