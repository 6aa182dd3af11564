"""``make compile``: machine code of the motion's kernels ahead of their first use.

numba keeps it in its cache, so that the first run, the first test or a demonstration does not wait
for it. Nothing else depends on it.
"""

from __future__ import annotations

import time

from thermogear import TorsionalModel, lyapunov_exponent, periodic_orbit, simulate


def main() -> None:
    began = time.perf_counter()
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.05,
    )
    simulate(model, periods=4)
    orbit = periodic_orbit(model)
    lyapunov_exponent(model, discard=20, batches=4, batch_periods=5)
    print(f"kernels compiled in {time.perf_counter() - began:.1f} s; period {orbit.period}")


if __name__ == "__main__":
    main()
