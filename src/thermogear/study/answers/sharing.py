"""Answers of the loaded contact: how many tooth pairs carry, and what tip corners carry of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided
from thermogear.study.corners import UNIFORM, HotContact, told
from thermogear.study.relief import one_point

SHARE = "How do the teeth share the load?"


def answers(asked: Asked) -> Iterator[Answer]:
    """Of the loaded contact at the operating point of the greatest power, hot."""
    case, point = asked.case, asked.hardest
    torque, at = float(case.stated.torque[point]), asked.at(point)
    why = asked.still(point) or "there is no load" * (not torque > 0.0)
    if not why:
        operating = one_point(case.operating_of(asked.model).point(point), torque)
        model = asked.model.override(stiffness="loaded")
        contact = HotContact(case=case, model=model, operating=operating)
        mesh = contact.solve(np.array([torque]), UNIFORM)
        lost = int(np.count_nonzero(~mesh.settled))
        why = f"{lost} of {UNIFORM.size} positions of the loaded contact do not settle" * (lost > 0)
    if why:
        yield undecided(SHARE, "effective_contact_ratio", why, at=at)
        yield undecided(SHARE, "edge_contact", why, at=at)
        return
    ratio = float(mesh.effective_ratio[0, 0])
    yield answer(
        SHARE,
        "effective_contact_ratio",
        f"Under load {ratio:.2f} tooth pairs carry on average, the effective contact ratio; as "
        "drawn it is {nominal:.2f}.",
        ratio,
        at=at,
        figures={"nominal": case.pair.contact_ratio},
    )
    load = mesh.corner_load[0, 0]
    words, figures = told(
        case,
        load=load,
        part=mesh.corner_part[0, 0],
        onset=contact.onset(torque)[0],
        yields=contact.yields(mesh)[0, 0],
    )
    words = f"{words[0].upper()}{words[1:]}." if words else "Tip corners carry 0 % of the load."
    yield answer(SHARE, "edge_contact", words, 100.0 * float(load.max()), at=at, figures=figures)
