"""Answers of the loaded contact: how many tooth pairs carry, and what tip corners carry of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from thermogear.mesh.thermal import HotPair
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided
from thermogear.study.corners import HotContact
from thermogear.study.relief import one_point

SHARE = "How do the teeth share the load?"


def answers(asked: Asked) -> Iterator[Answer]:
    """Of the loaded contact at the operating point of the greatest power, hot."""
    case, point = asked.case, asked.hardest
    torque, at = float(case.stated.torque[point]), asked.at(point)
    why = asked.still(point) or "there is no load" * (not torque > 0.0)
    if not why:
        operating = one_point(case.operating_of(asked.model).point(point), torque)
        hot = HotPair(case.pair, operating, asked.model.override(stiffness="loaded"))
        mesh, words, figures = HotContact(hot, asked.mean_tooth).told(torque)
        if lost := int(np.count_nonzero(~mesh.settled)):
            why = f"{lost} of {mesh.settled.size} positions of the loaded contact do not settle"
    if why:
        for name in ("effective_contact_ratio", "edge_contact"):
            yield undecided(SHARE, name, why, at=at)
        return
    ratio = float(mesh.effective_ratio[0, 0])
    whose = "; of the mean tooth" * (asked.mesh_periods > 1)
    yield answer(
        SHARE,
        "effective_contact_ratio",
        f"Under load {ratio:.2f} tooth pairs carry on average, the effective contact ratio; "
        f"the nominal one is {{nominal:.2f}}{whose}.",
        ratio,
        at=at,
        figures={"nominal": case.pair.contact_ratio},
    )
    if case.pair.cut_short:
        why = "undercut ends the path, and its edge is not told from the mate's tip corner"
        yield undecided(SHARE, "edge_contact", why, at=at)
        return
    words = f"At these temperatures, {words or 'tip corners carry 0 % of the load'}{whose}."
    yield answer(
        SHARE,
        "edge_contact",
        words,
        100.0 * float(mesh.corner_load.max()),
        at=at,
        figures=figures,
        units=dict.fromkeys(("wheel_onset", "pinion_onset"), "N m"),
    )
