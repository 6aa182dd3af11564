"""Run a drive train through its mesh periods: which step next, contacts that change, tangents.

Steps of halved lengths stand ready (``ladder``). A step that misses the tolerance, or whose sweeps
do not settle, is taken again on a shorter one; where a contact changes the step ends.
Checked by ``tests/dynamics/test_geared_truth.py`` against public truth cases, and by
``tests/dynamics/test_geared_reference.py``.
"""

from __future__ import annotations

import math

from thermogear.dynamics.kernels.calculus import along, first_root
from thermogear.dynamics.kernels.compiled import kernel, part, small
from thermogear.dynamics.kernels.drive import (
    BACK_ERROR,
    BACKLASH,
    BEARINGS,
    ERROR,
    FELT,
    FREQUENCY,
    FRICTION,
    INPUTS,
    MODES,
    NODES,
    OUTPUTS,
    RAMP,
    ROUGH,
    RUNGS,
    SPAN,
    TOLERANCE,
    TURN,
    Real,
    Train,
    excite,
    gap_of,
    located,
    outputs_of,
)
from thermogear.dynamics.kernels.drive_tangent import carry_tangent
from thermogear.dynamics.kernels.ladder import (
    EVENTS,
    FORCED,
    HUGE,
    IMPACTS,
    LIFTS,
    LOSSES,
    REJECTED,
    STEPS,
    UNSEEN,
    Ladder,
    Work,
    attempt,
    coefficients,
    fill,
    periodic_values,
    within,
)
from thermogear.dynamics.kernels.vector import EIGHT

ALIKE = 1e-9
"""Share of the longest step that two times may differ by and be one."""
TOUCHING = 1e-7
"""Share of the half backlash below which a gap is none: it moves no impact beyond rounding."""
MOST_STEPS = 200_000
"""Steps in one period; more is taken for a motion that runs away."""


@small
def gap_at(train: Train, work: Work, contact: int, outputs: Real, at: int, row: int) -> float:
    """Penetration of a contact from ``outputs[at:]`` and the functions in ``row``."""
    o = at if contact < 2 else at + 2 * contact - 2
    error = work.values[EIGHT * row + (ERROR if contact == 0 else BACK_ERROR)]
    return float(gap_of(train, contact, outputs[o], outputs[o + 1], error))


@part
def contacts_of(train: Train, work: Work, state: Real) -> None:
    """Which contacts are closed at phase 0."""
    outputs_of(train, state, work.ends, 0)
    excite(train, 0.0, train.numbers[TURN], work.values, 0)
    for c in range(2 + train.sizes[BEARINGS]):
        gap = gap_at(train, work, c, work.ends, 0, 0) if located(train, c) else 1.0
        work.closed[c] = 1 if gap > 0.0 else 0
        work.held[c] = 0


@part
def first_change(train: Train, ladder: Ladder, work: Work) -> tuple[int, float]:
    """The contact that changes first in the step just solved, and at which share; -1, 2: none."""
    nodes, outputs = train.sizes[NODES], train.sizes[OUTPUTS]
    rounding = TOUCHING * train.numbers[BACKLASH]
    who = -1
    when = 2.0
    for c in range(2 + train.sizes[BEARINGS]):
        if not located(train, c) or work.held[c] > 2:
            continue
        sign = -1.0 if work.closed[c] == 1 else 1.0
        gaps = work.gaps
        gaps[0] = sign * gap_at(train, work, c, work.ends, 0, nodes)
        for i in range(nodes):
            gaps[i + 1] = sign * gap_at(train, work, c, work.y, i * outputs, i)
        gaps[nodes + 1] = sign * gap_at(train, work, c, work.ends, train.sizes[FELT], nodes + 1)
        fresh = work.held[c] < 0
        share = first_root(nodes + 2, ladder.places, ladder.weights, gaps, rounding, fresh)
        if share < when:
            who, when = c, share
    return who, when


@small
def change(train: Train, work: Work, contact: int) -> None:
    """Close or open a contact, and count it."""
    work.counts[EVENTS] += 1
    if contact == 0 and work.closed[0] == 1:
        work.counts[LOSSES] += 1
    if contact == 1 and work.closed[1] == 0:
        work.counts[IMPACTS] += 1
    if contact >= 2 and work.closed[contact] == 1:
        work.counts[LIFTS] += 1
    work.closed[contact] = 1 - work.closed[contact]


@part
def polished(
    train: Train,
    ladder: Ladder,
    work: Work,
    state: Real,
    contact: int,
    share: float,
    h: float,
    t: float,
) -> float:
    """The share at which a contact changes, by the exact states; leaves that state in ``trial``."""
    nodes, felt = train.sizes[NODES], train.sizes[FELT]
    f0, ramp = train.numbers[FREQUENCY], train.numbers[RAMP]
    rounding = TOUCHING * train.numbers[BACKLASH]
    sign = -1.0 if work.closed[contact] == 1 else 1.0
    before = 0.0
    gap_before = 0.0
    for step in range(6):
        within(train, ladder, work, share, h, state, work.trial)
        outputs_of(train, work.trial, work.ends, felt)
        now = t + share * h
        phase = (f0 + 0.5 * ramp * now) * now
        turned = train.numbers[TURN] + phase
        excite(train, phase - math.floor(phase), turned, work.values, nodes + 1)
        gap = sign * gap_at(train, work, contact, work.ends, felt, nodes + 1)
        if abs(gap) <= 0.2 * rounding or step == 5:
            break
        if step == 0:
            near = min(share + 1e-4, 1.0)
            slope = (
                along(near, nodes + 2, ladder.places, ladder.weights, work.gaps)
                - along(near - 2e-4, nodes + 2, ladder.places, ladder.weights, work.gaps)
            ) / 2e-4
        else:
            slope = (gap - gap_before) / (share - before) if share != before else 0.0
        if slope <= 0.0:
            break
        before, gap_before = share, gap
        moved = min(max(share - gap / slope, 0.0), 1.0)
        if abs(moved - share) > 0.1 or abs(moved - share) < 1e-14:
            break
        share = moved
    return share


@part
def next_step(
    train: Train,
    ladder: Ladder,
    work: Work,
    rung: int,
    finest: int,
    remaining: float,
    over: bool,
) -> tuple[int, float]:
    """The table for the next step, and the share of it that is left to the border.

    A step that is cut is of the rung ``finest`` or below; before it come longer ones that are not.
    ``over``: towards a contact's change, which a step must reach over.
    """
    rungs = train.sizes[RUNGS]
    close = ALIKE * ladder.lengths[0]
    if not over and remaining >= ladder.lengths[rung] - close:
        return rung, 1.0
    wanted = 1.02 * remaining if over else remaining - close
    while rung + 1 < rungs and ladder.lengths[rung + 1] >= wanted:
        rung += 1
    if not over and ladder.lengths[rung] <= remaining + close:
        return rung, 1.0
    # not to be cut yet: the longest step that ends before
    before = 0.98 * remaining if over else remaining + close
    while rung < finest and ladder.lengths[rung] > before:
        rung += 1
    if over or ladder.lengths[rung] <= remaining + close:
        return rung, 1.0
    return rung, remaining / ladder.lengths[rung]


@part
def draw(
    train: Train,
    ladder: Ladder,
    work: Work,
    state: Real,
    sampled: Real,
    samples: int,
    period: int,
    drawn: int,
    t: float,
    h: float,
    after: float,
) -> int:
    """States at the uniform phases within the step just solved; the number of the next phase."""
    f0, ramp = train.numbers[FREQUENCY], train.numbers[RAMP]
    span = train.sizes[SPAN]
    while drawn < samples:
        phase = drawn / samples
        at = 2.0 * phase / (f0 + math.sqrt(f0 * f0 + 2.0 * ramp * phase))
        if at >= after:
            break
        within(train, ladder, work, (at - t) / h, h, state, work.sample)
        row = (period * samples + drawn) * span
        for k in range(span):
            sampled[row + k] = work.sample[k]
        drawn += 1
    return drawn


@kernel
def advance(
    train: Train,
    ladder: Ladder,
    work: Work,
    periods: int,
    samples: int,
    columns: int,
    state: Real,
    tangent: Real,
    sections: Real,
    sampled: Real,
    times: Real,
) -> int:
    """Carry one state through ``periods`` mesh periods; 0, or 1 where no step is short enough.

    ``state`` (span) and ``tangent`` (columns, span) are changed in place. ``sections`` (periods,
    span) and ``times`` (periods) [s]: the state at the end of every period, how long it took;
    ``sampled`` (periods samples, span) from the phase 0 of the first one on. With a ramp
    ``train.numbers`` goes on.
    """
    sizes, numbers = train.sizes, train.numbers
    modes, nodes, inputs = sizes[MODES], sizes[NODES], sizes[INPUTS]
    felt, span = sizes[FELT], sizes[SPAN]
    first = 4 if sizes[FRICTION] == 1 else 2
    outside = first + 2 * sizes[BEARINGS]
    rungs = sizes[RUNGS]
    close = ALIKE * ladder.lengths[0]
    tolerance = numbers[TOLERANCE]
    rung = 0
    finest = 0
    t_known = 0.0
    h_known = 0.0
    contacts_of(train, work, state)
    for period in range(periods):
        t = 0.0
        taken = 0
        begin = 0.0
        drawn = 0
        f0, ramp = numbers[FREQUENCY], numbers[RAMP]
        for number in range(train.borders.size):
            border = train.borders[number]
            t_border = 2.0 * border / (f0 + math.sqrt(f0 * f0 + 2.0 * ramp * border))
            target = HUGE
            while t_border - t > 0.01 * close:
                taken += 1
                if taken > MOST_STEPS:
                    return 1
                if target - t <= close:
                    target = HUGE
                over = target < t_border
                goal = target if over else t_border
                here, limit = next_step(train, ladder, work, rung, finest, goal - t, over)
                h = ladder.lengths[here]
                if over and h > t_border - t + close:
                    limit = (t_border - t) / h
                periodic_values(train, ladder, work, t, h, begin, border)
                lead = (t - t_known) / h_known if h_known > 0.0 else -1.0
                stretch = h / h_known if h_known > 0.0 else 0.0
                error = attempt(train, ladder, work, state, here, t, lead, stretch)
                work.counts[STEPS] += 1
                if error > tolerance:
                    shorter = here + 1
                    while shorter < rungs and ladder.lengths[shorter] >= h:
                        shorter += 1
                    if error >= HUGE:
                        h_known = 0.0
                    if shorter < rungs:
                        work.counts[REJECTED] += 1
                        rung = shorter
                        continue
                    if error >= HUGE:
                        return 1
                    work.counts[FORCED] += 1
                who, when = first_change(train, ladder, work)
                if who >= 0 and when <= 0.0:
                    # closed or open already at the start
                    work.held[who] = max(work.held[who], 0) + 1
                    change(train, work, who)
                    continue
                cut = limit < 1.0 or when < limit
                beside = work.pace[1]
                if cut and beside > tolerance and here + 1 < rungs:
                    # nearer to the cut by whole steps first
                    finest = here + 1
                    fall = 0.5 ** (nodes + 2)
                    while finest + 1 < rungs and beside * fall > tolerance:
                        finest += 1
                        beside *= fall
                    if when < limit:
                        target = t + when * h
                    work.counts[REJECTED] += 1
                    continue
                if cut and finest > 0 and beside * 2.0 ** (nodes + 3) < tolerance:
                    finest -= 1
                low = 0 if cut or samples > 0 else first
                high = inputs if cut or samples > 0 else outside
                coefficients(train, ladder, work, low, high)
                share = limit
                if when < limit:
                    share = polished(train, ladder, work, state, who, when, h, t)
                    target = HUGE
                else:
                    who = -1
                    if limit < 1.0:
                        within(train, ladder, work, limit, h, state, work.trial)
                        outputs_of(train, work.trial, work.ends, felt)
                after = t + share * h
                if who < 0 and (limit < 1.0 or abs(t_border - after) <= close):
                    after = t_border
                if samples > 0:
                    drawn = draw(
                        train,
                        ladder,
                        work,
                        state,
                        sampled,
                        samples,
                        period,
                        drawn,
                        t,
                        h,
                        after,
                    )
                if columns > 0:
                    whole = here
                    pace = work.pace[0]
                    if cut:
                        # the tangent's own step ends where this one is cut
                        whole = rungs
                        for k in range(2 * modes):
                            work.sample[k] = work.trial[k]
                        fill(train, ladder, work, whole, share * h)
                        periodic_values(train, ladder, work, t, share * h, begin, border)
                        attempt(train, ladder, work, state, whole, t, 0.0, share)
                    carry_tangent(train, ladder, work, tangent, columns, whole, t)
                    if cut:
                        work.pace[0] = pace
                        for k in range(2 * modes):
                            work.trial[k] = work.sample[k]
                        outputs_of(train, work.trial, work.ends, felt)
                place = 2 if work.closed[0] == 1 else (0 if work.closed[1] == 1 else 1)
                work.spent[place] += after - t
                for k in range(2 * modes):
                    state[k] = work.trial[k]
                for o in range(felt):
                    work.ends[o] = work.ends[felt + o]
                t_known, h_known = t, h
                t = after
                for c in range(2 + sizes[BEARINGS]):
                    work.held[c] = 0
                if who >= 0:
                    change(train, work, who)
                    work.held[who] = -1
                    # how fast sweeps settle now is not known
                    work.pace[0] = 1.0
                    if who >= 2:
                        h_known = 0.0
                elif here == rung and here > 0 and limit == 1.0:
                    # a longer step, where its error would be small enough
                    grown = 0.0
                    for c in range(inputs):
                        grown += ladder.miss[(here - 1) * inputs + c] * work.lacking[c]
                    grown *= 2.0**nodes
                    if sizes[ROUGH] == 1:
                        grown = max(grown, UNSEEN * beside * 2.0**nodes)
                    if grown < 0.5 * tolerance:
                        rung = here - 1
            t = t_border
            begin = border
        finite = 0.0
        for k in range(2 * modes):
            sections[period * span + k] = state[k]
            finite += state[k]
        times[period] = t
        t_known -= t
        numbers[TURN] += 1.0
        numbers[FREQUENCY] = math.sqrt(f0 * f0 + 2.0 * ramp)
        if not abs(finite) < HUGE:
            return 1
    return 0
