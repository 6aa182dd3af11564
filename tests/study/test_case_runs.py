"""A case that is computed again with a field changed by a factor."""

from __future__ import annotations

from thermogear.study.case_runs import overrides_of


def test_overrides_scale_values_with_their_units() -> None:
    text = "[dynamics]\ndamping_ratio = 0.1\n[transmission_error]\nharmonics = [{ order = 1, "
    text += 'amplitude = "4 um" }]\n'
    assert overrides_of(text, {}, "dynamics.damping_ratio", 1.5) == {
        "dynamics.damping_ratio": str(0.1 * 1.5)
    }
    assert overrides_of(text, {}, "zeta", 1.5) == {"dynamics.damping_ratio": str(0.1 * 1.5)}
    assert overrides_of(text, {}, "transmission_error.amplitude", 2.0) == {
        "transmission_error.harmonics.0.amplitude": "8.0 um"
    }
