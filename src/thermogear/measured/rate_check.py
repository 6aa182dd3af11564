"""Whether the sampling rate fits the teeth and the speed that are known."""

from __future__ import annotations

import numpy as np

from thermogear.base.bounds import SPEED
from thermogear.measured.gearing import NEAR, Gearing
from thermogear.measured.record import Notice, Record

_TOLD = 0.005


def check_rate(
    record: Record,
    gearing: Gearing,
    notices: list[Notice],
    *,
    teeth: int | None,
    speed: float | None,
    undecided: bool = False,
) -> str:
    """Why the rate is doubtful, "" where it is not: against teeth and speed where these are known.

    A rate given that contradicts the file's is kept where teeth and speed confirm it. The rate is
    doubted, beside the speed, only where the mesh line has the sidebands of the teeth given.
    ``undecided``: it may be another gear's.
    """
    if teeth is None:
        return record.rate_doubt
    turns = gearing.mesh_frequency / teeth  # turns per sample
    if record.rate is None:
        if speed is not None:
            rate = speed / (2.0 * np.pi) / turns
            notices.append(Notice.of("rate_by_speed", speed=speed, rate=rate))
        return ""
    implied = turns * record.rate
    shaft = implied if speed is None else speed / (2.0 * np.pi)
    found = 2.0 * np.pi * implied
    if found > SPEED.most:
        notices.append(
            Notice.of(
                "speed_impossible", rate=record.rate, teeth=teeth, speed=found, most=SPEED.most
            )
        )
    else:
        nominal = not undecided and _TOLD < abs(implied / shaft - 1.0) <= NEAR
        notices.append(
            Notice.of(
                "speed_if_mesh_line" if undecided else "speed_by_rate",
                rate=record.rate,
                teeth=teeth,
                speed=found,
                given=speed if nominal else None,
            )
        )
    if 2.56 * gearing.mesh_frequency > 1.0:
        notices.append(Notice.of("aliases_possible"))
    if speed is None:
        return record.rate_doubt
    ratio = implied / shaft
    if abs(ratio - 1.0) <= NEAR:
        return ""
    if not gearing.confirmed:
        # what the mesh line is, is open: it contradicts nobody
        notices.append(
            Notice.of("mesh_line_does_not_fit", line=gearing.mesh_frequency, given=speed)
        )
        return record.rate_doubt
    told = Notice.of(
        "speed_contradicts_rate",
        given=speed,
        found=found,
        line=gearing.mesh_frequency,
        teeth=teeth,
        rate=record.rate,
        ratio=ratio,
        fitting=record.rate / ratio,
    )
    notices.append(told)
    return told.text
