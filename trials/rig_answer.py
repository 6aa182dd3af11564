"""What the sampled drive trains say of the thesis's experiment: shares, a sentence, what decides.

Rules set before the shares were counted: a place shows the printed displacements where one and the
same channel lies within a factor :data:`NEAR` of them at all three speeds and grows; the answer is
"no" where the upper end of the 95 % interval of the share is below :data:`NO`, "yes" where its
lower end is above :data:`YES`, else "undecided". Trains without a motion count against either end.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from rig_samples import ASSUMED, FIXED, PRINTED, SEEN, SPEEDS, WORDS, Shown

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import MICROMETRE, PERCENT, SPEED
from thermogear.base.vocabulary import label
from thermogear.thesis.base_sets import interval

NEAR = 1.5
"""Peak or rms (1.41) and an unstated processing together."""
LIMITS = (1.25, NEAR, 2.0, 3.0)
NO, YES = 0.05, 0.5
EITHER = "either"
"""An accelerometer on a bearing's cap or on the housing, whichever is nearer."""
TOLD = {EITHER: "accelerometer on a cap or on the housing", **WORDS}
QUANTILES = (0.05, 0.5, 0.95)
BOOTSTRAP, BOOTSTRAP_SEED = 500, 1
TARGETS = {
    "factor": "how far the nearest accelerometer is off",
    "cap": "largest displacement of a cap at 3000 rpm",
    "teeth": "deflection of the teeth at 3000 rpm",
}


def factor(one: Shown, seen: str) -> float:
    """The factor that separates the nearest channel from the printed values; inf: none."""
    if seen == EITHER:
        return min(one.factor("cap"), one.factor("housing"))
    return one.factor(seen)


def _comes_out(one: Shown, seen: str, limit: float) -> bool:
    places = ("cap", "housing") if seen == EITHER else (seen,)
    return any(
        one.factor(place) <= limit and bool(np.all(np.diff(one.amplitudes[place]) > 0.0))
        for place in places
    )


def answer(*, low: float, high: float) -> str:
    """ "no", "yes" or "undecided" by the interval of the share."""
    if high < NO:
        return "no"
    return "yes" if low > YES else "undecided"


def rank_correlations(inputs: Floats, *, outputs: Floats) -> Floats:
    """Spearman's rho (output, input) of samples in rows, equal values sharing their mean rank.

    Nan where a column has one value.

    >>> x = np.array([[1.0], [2.0], [3.0]])
    >>> rank_correlations(x, outputs=x**3)
    array([[1.]])
    """
    from scipy.stats import rankdata

    unit = []
    for table in (inputs, outputs):
        ranks = rankdata(table, axis=0) - 0.5 * (table.shape[0] + 1)
        with np.errstate(invalid="ignore"):
            unit.append(ranks / np.linalg.norm(ranks, axis=0))
    return np.asarray(unit[1].T @ unit[0])


def _ranks(rows: Sequence[Shown]) -> tuple[Floats, Floats]:
    """Rank correlation (target, input) and its standard error by a bootstrap over the samples."""
    moving = [one for one in rows if one.moves]
    inputs = np.array([[one.values[a.name] for a in ASSUMED] for one in moving])
    last = len(SPEEDS) - 1
    targets = np.array(
        [
            [factor(one, EITHER), one.most["cap"][last], one.amplitudes["teeth"][last]]
            for one in moving
        ]
    )
    rng = np.random.default_rng(BOOTSTRAP_SEED)
    found = rank_correlations(inputs, outputs=targets)
    drawn = [
        rank_correlations(inputs[some], outputs=targets[some])
        for some in rng.integers(0, len(moving), (BOOTSTRAP, len(moving)))
    ]
    return found, np.asarray(np.nanstd(drawn, axis=0, ddof=1))


def results(rows: Sequence[Shown]) -> Dataset:
    """Everything that the page shows of the sampled trains."""
    lost = sum(not one.moves for one in rows)
    seen = tuple(TOLD)
    hits = np.array([[sum(_comes_out(one, s, f) for one in rows) for f in LIMITS] for s in seen])
    ends = np.array([[interval(int(n), count=len(rows), lost=lost) for n in line] for line in hits])
    size = np.array([[one.most[place] for one in rows] for place in SEEN])
    near = np.array([[one.amplitudes[place] for one in rows] for place in SEEN])
    needed = np.array([[factor(one, s) for one in rows] for s in seen])
    rank, scatter = _ranks(rows)
    with np.errstate(invalid="ignore"):
        spread = np.nanquantile(size, QUANTILES, axis=1).transpose(1, 2, 0)
    at = LIMITS.index(NEAR)
    said = answer(low=float(ends[0, at, 0]), high=float(ends[0, at, 1]))
    labels = [name for one in rows for name in one.labels]
    open_ = np.array(["undecided" in one.labels for one in rows])
    counted = {name: labels.count(name) for name in sorted(set(labels))}
    entries: dict[str, Any] = {
        "hits": (("seen", "limit"), hits, "1", "trains that show the printed displacements"),
        "share": (("seen", "limit"), hits / len(rows), "1", "share of all trains"),
        "share_low": (("seen", "limit"), ends[..., 0], "1", "lower end of its 95 % interval"),
        "share_high": (("seen", "limit"), ends[..., 1], "1", "upper end of its 95 % interval"),
        "needed_factor": (("seen", "train"), needed, "1",
                          "largest ratio of the nearest channel to the printed values"),
        "spread": (("place", "rig_speed", "quantile"), spread, "m",
                   "largest displacement of any channel"),
        "nearest": (("place", "train", "rig_speed"), near, "m",
                    "displacement of the nearest channel"),
        "printed": (("rig_speed",), np.array(PRINTED), "m", "displacement as printed"),
        "rank": (("target", "input"), rank, "1", "rank correlation"),
        "rank_error": (("target", "input"), scatter, "1", "standard error of it (bootstrap)"),
        "seen_words": (("seen",), list(TOLD.values())),
        "place_words": (("place",), [WORDS[place] for place in SEEN]),
        "target_words": (("target",), list(TARGETS.values())),
        "input_words": (("input",), [one.words for one in ASSUMED]),
        "input_range": (("input",), [one.span for one in ASSUMED]),
        "input_why": (("input",), [one.why for one in ASSUMED]),
    }  # fmt: skip
    found = label(
        entries,
        {
            "seen": ("seen", list(seen)),
            "place": ("place", list(SEEN)),
            "limit": ("limit", np.array(LIMITS), "1", "factor allowed"),
            "rig_speed": ("rig_speed", SPEED.stored(SPEEDS), "rad/s", "pinion speed"),
            "quantile": ("quantile", np.array(QUANTILES), "1", "quantile"),
        },
    )
    told = {
        "answer": said,
        "trains": len(rows),
        "lost": lost,
        "near": NEAR,
        "open": int(np.sum(open_)),
        "open_nearest": float(np.min(needed[0, open_])) if np.any(open_) else float("nan"),
        "largest": float(np.nanmax(size[:2, :, -1])),
        "motions": ", ".join(f"{name} {number}" for name, number in counted.items()),
        "fixed": FIXED,
    }
    found = found.assign_attrs(told)
    return found.assign_attrs(sentence=sentence(found), deciding=deciding(found))


def sentence(data: Dataset) -> str:
    """The answer with its share and spread, in one sentence."""
    one = data.sel(seen=EITHER).isel(limit=LIMITS.index(NEAR))
    nearest = float(np.min(data["needed_factor"].sel(seen=EITHER).values))
    said = {
        "no": "No, under these assumptions: the printed displacements do not come out of",
        "yes": "Yes, under these assumptions: the printed displacements come out of",
        "undecided": "Undecided: the printed displacements may come out of",
    }[str(data.attrs["answer"])]
    last = MICROMETRE(float(data.attrs["largest"]))
    return (
        f"{said} an accelerometer on a bearing's cap or on the housing. On {int(one['hits'])} of "
        f"{data.attrs['trains']} sampled drive trains one shows 10.4, 19.3 and 48.5 µm within a "
        f"factor {NEAR:g} at all three speeds, growing ({PERCENT(float(one['share'])):.1f} %, 95 % "
        f"interval {PERCENT(float(one['share_low'])):.1f} to "
        f"{PERCENT(float(one['share_high'])):.1f} %, "
        f"{data.attrs['lost']} without a motion counted against either end); the nearest is off "
        f"by a factor {nearest:.2f}, and the largest displacement of any of them at 3000 rpm is "
        f"{last:.1f} µm."
    )


def deciding(data: Dataset) -> str:
    """What decides it: the inputs whose rank correlation is beyond three standard errors."""
    parts = []
    for name, words in TARGETS.items():
        one = data.isel(target=list(TARGETS).index(name))
        rank, error = one["rank"].values, one["rank_error"].values
        order = np.argsort(-np.abs(rank), kind="stable")
        sure = [k for k in order if abs(rank[k]) > 3.0 * error[k]][:4]
        listed = ", ".join(
            f"{one['input_words'].values[k]} ({rank[k]:+.2f} ± {error[k]:.2f})" for k in sure
        )
        parts.append(f"{words}: {listed or 'nothing beyond three standard errors'}")
    return "; ".join(parts).replace("-", "−")
