"""The parameter points every solver gets, and the classes of motion that are timed apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermogear.dynamics.models import TorsionalModel

COUNT = 512
SEED = 20240511


@dataclass(frozen=True, eq=False)
class Points:
    """Arrays (point,) of zeta, w, eps, F_m, F_h (b' = 1, eps_T = 0) and the starts (point, 2)."""

    zeta: np.ndarray
    w: np.ndarray
    eps: np.ndarray
    mean: np.ndarray
    force: np.ndarray
    start: np.ndarray

    def __len__(self) -> int:
        return self.zeta.size

    def model(self) -> TorsionalModel:
        return TorsionalModel(
            damping_ratio=self.zeta,
            frequency=self.w,
            stiffness_amplitude=self.eps,
            mean_force=self.mean,
            force_amplitude=self.force,
        )

    def take(self, count: int) -> Points:
        """``count`` points spread evenly."""
        at = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        fields = (self.zeta, self.w, self.eps, self.mean, self.force, self.start)
        return Points(*(field[at] for field in fields))


def random_points(count: int = COUNT) -> Points:
    """Half general, half rattling with |F_h|/F_m from 5 to 70."""
    rng = np.random.default_rng(SEED)
    half = count // 2
    rattling = count - half

    def both(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return np.concatenate([one, other])

    sign = rng.choice([-1.0, 1.0], count)
    mean = both(rng.uniform(0.05, 0.2, half), 10 ** rng.uniform(-1.9, -1.0, rattling))
    force = both(rng.uniform(0.02, 0.3, half), mean[half:] * rng.uniform(5.0, 70.0, rattling))
    return Points(
        rng.uniform(0.03, 0.18, count),
        both(rng.uniform(0.4, 1.8, half), rng.uniform(0.6, 1.6, rattling)),
        rng.uniform(0.05, 0.45, count),
        mean,
        sign * force,
        np.zeros((count, 2)),
    )


def classes(count: int = 128) -> dict[str, Points]:
    """Motions of one kind each: what the exact maps' speed depends on."""
    rng = np.random.default_rng(SEED + 1)

    def near(value: float, spread: float) -> np.ndarray:
        return value * (1.0 + spread * rng.uniform(-1.0, 1.0, count))

    def same(value: float) -> np.ndarray:
        return np.full(count, value)

    def start(x: float, v: float) -> np.ndarray:
        return np.tile([x, v], (count, 1))

    return {
        "contact only": Points(
            near(0.05, 0.3), near(0.6, 0.1), near(0.1, 0.3), same(0.2), same(0.05), start(1.2, 0.0)
        ),
        "one or two crossings a period": Points(
            near(0.05, 0.1), near(1.1, 0.03), same(0.2), same(0.1), same(0.2), start(0.0, 0.0)
        ),
        "rattling, |F_h|/F_m = 68": Points(
            near(0.15, 0.15), near(1.245, 0.02), near(0.335, 0.1), same(0.017), same(-1.16),
            start(0.0, 0.0),
        ),
        "back-side impacts": Points(
            near(0.05, 0.1), near(0.7, 0.02), same(0.2), same(0.1), same(0.2), start(2.0, 1.0)
        ),
        "low frequency, w .12-.35": Points(
            near(0.05, 0.3), rng.uniform(0.12, 0.35, count), same(0.3), same(0.05), same(0.25),
            start(0.0, 0.0),
        ),
        "all lanes grazing": Points(
            same(0.05), same(0.7733103356255804), same(0.1), same(0.1), same(0.05),
            start(1.1954104642733394, 0.01479006606425257),
        ),
    }  # fmt: skip
