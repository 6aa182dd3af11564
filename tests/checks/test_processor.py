"""A wrong quotient is seen whatever divides."""

import numpy as np
from scripts import script

PROCESSOR = script("processor")
first_wrong, numbers = PROCESSOR.first_wrong, PROCESSOR.numbers


def test_a_quotient_off_by_one_bit_in_one_place_is_seen() -> None:
    a, b, exact = numbers()
    assert np.max(np.abs(exact * b / a - 1.0)) < 1e-10

    def defective(x, y):
        found = exact.copy()
        found[77] = np.nextafter(found[77], 9.0)
        return found

    wrong, made = first_wrong(1.0, defective)
    assert wrong is not None
    assert wrong.startswith(f"{float(a[77])!r}/{float(b[77])!r} = {float(exact[77])!r}")
    assert made == exact.size


def test_exact_quotients_pass() -> None:
    exact = numbers()[2]
    assert first_wrong(0.01, lambda x, y: exact)[0] is None
