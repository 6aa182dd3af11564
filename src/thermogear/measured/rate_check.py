"""Whether the sampling rate fits the teeth and the speed that are known."""

from __future__ import annotations

import numpy as np

from thermogear.base.bounds import SPEED
from thermogear.measured.contradictions import NEAR
from thermogear.measured.gearing import Gearing
from thermogear.measured.record import Notice, Record

SURE = 0.9
"""Weight of all that has one line, from which that line is beyond doubt."""
_TOLD = 0.005
_FACTORS = {
    10.0: "ten times too high",
    0.1: "ten times too low",
    100.0: "a hundred times too high",
    0.01: "a hundred times too low",
    1000.0: "a thousand times too high (milliseconds read as seconds?)",
    0.001: "a thousand times too low (seconds read as milliseconds?)",
    2.0: "twice too high",
    0.5: "twice too low",
    2.56: "2.56 times too high (bandwidth and rate exchanged?)",
    1 / 2.56: "2.56 times too low (bandwidth and rate exchanged?)",
    60.0: "sixty times too high (turns per minute and per second exchanged?)",
    1 / 60.0: "sixty times too low (turns per minute and per second exchanged?)",
}


def check_rate(
    record: Record,
    gearing: Gearing,
    notices: list[Notice],
    *,
    teeth: int | None,
    given: int | None,
    speed: float | None,
    undecided: bool = False,
) -> str:
    """Why the rate is doubtful, "" where it is not: against teeth and speed where these are known.

    A rate given that contradicts the file's is kept where teeth and speed confirm it. The rate is
    doubted, beside the speed, only where the teeth are decided, or are ``given`` and the mesh line
    is beyond doubt, and no reading of the lines with any weight fits the speed (and the teeth
    ``given``, or those decided). ``undecided``: the mesh line may be another gear's.
    """
    if teeth is None:
        return record.rate_doubt
    turns = gearing.mesh_frequency / teeth  # turns per sample
    if record.rate is None:
        if speed is not None:
            notices.append(
                Notice(
                    "info",
                    f"if the shaft turns at the {speed * 30 / np.pi:.6g} rpm given, the rate is "
                    f"{speed / (2 * np.pi) / turns:.6g} samples/s (not adopted)",
                )
            )
        return ""
    implied = turns * record.rate
    shaft = implied if speed is None else speed / (2.0 * np.pi)
    nominal = f"; the {60 * shaft:.6g} rpm given count as nominal"
    told = _TOLD < abs(implied / shaft - 1.0) <= NEAR
    if undecided:
        nominal, told = ", if this mesh line is theirs", True
    text = f"the rate {record.rate:g}/s and {teeth} teeth make the shaft turn at "
    text += f"{60 * implied:.6g} rpm{nominal if told else ''}"
    high = 60 * implied > SPEED.high
    text += f"; shafts turn at up to {SPEED.ends[1]}: is the rate right?" if high else ""
    notices.append(Notice("warning" if high else "info", text))
    if 2.56 * gearing.mesh_frequency > 1.0:
        notices.append(Notice.of("aliases_possible"))
    if speed is None:
        return record.rate_doubt
    ratio = implied / shaft
    if abs(ratio - 1.0) <= NEAR:
        return ""
    weighed = gearing.weighed
    if weighed.fits(shaft / record.rate, teeth=given, tolerance=NEAR):
        return record.rate_doubt
    if any(abs(implied * teeth / z / shaft - 1.0) <= NEAR for z in weighed.teeth):
        return record.rate_doubt  # the speed given is that of the teeth found: others are told of
    doubtless = given is not None and weighed.line_weight >= SURE
    if weighed.verdict != "decided" and not doubtless:
        # what the mesh line is, is open: it contradicts nobody
        notices.append(
            Notice(
                "warning",
                f"the mesh line read at {gearing.mesh_frequency:.6f} cycles/sample does not fit "
                f"the {speed * 30 / np.pi:.6g} rpm given, and the record does not decide that it "
                "is one",
            )
        )
        return record.rate_doubt
    named = min(_FACTORS, key=lambda factor: abs(np.log(ratio / factor)))
    what = (
        f"the rate looks {_FACTORS[named]}"
        if abs(ratio / named - 1.0) <= NEAR
        else f"the rate is wrong by a factor {ratio:.4g}"
    )
    both = f"speed given: {speed * 30 / np.pi:.6g} rpm; found: {60 * implied:.6g} rpm"
    or_teeth = "" if given in (None, *weighed.teeth) else ", the teeth given"
    notices.append(
        Notice(
            "important",
            f"{both} (mesh line at {gearing.mesh_frequency:.6f} cycles/sample over {teeth} teeth, "
            f"{record.rate:g} samples/s). The speed given may be wrong{or_teeth}, or {what}: a "
            f"rate of {record.rate / ratio:.6g} would fit",
        )
    )
    return both
