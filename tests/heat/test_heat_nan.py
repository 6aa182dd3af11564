"""What is not a number never counts as solved: networks, jams, films, fields, readings."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import ConvergenceError, InputError
from thermogear.heat import convection
from thermogear.heat.convection import disc_nusselt, rotating_disc_gradient
from thermogear.heat.film import film_parameter, regime, regime_shares
from thermogear.heat.gearbox import Losses
from thermogear.heat.measured_temperature import infrared_temperature
from thermogear.heat.moving_source import moving_source_rise, peclet_factor
from thermogear.heat.network import Link, ThermalNetwork

NAN = float("nan")
LINK = Link("body", "ambient", 4.0)
AMBIENT = {"ambient": 293.15}


def test_a_network_wants_numbers_everywhere() -> None:
    with pytest.raises(InputError, match=r"^conductance body-ambient: got nan; allowed >= 0 W/K"):
        Link("body", "ambient", NAN)
    with pytest.raises(InputError, match=r"^temperature of ambient: got nan K; allowed > 0 K"):
        ThermalNetwork((LINK,), {}, {"ambient": NAN})
    with pytest.raises(InputError, match=r"^source of body: got \[50\. nan\] W; allowed finite$"):
        ThermalNetwork((LINK,), {"body": [50.0, NAN]}, AMBIENT)
    with pytest.raises(InputError, match=r"^losses\.mesh: got nan W; allowed >= 0, finite$"):
        Losses(mesh=NAN)


def test_an_unknown_film_is_in_no_regime() -> None:
    with pytest.raises(InputError, match=r"^film parameter: got nan; allowed a number, or inf"):
        regime([0.5, NAN])
    with pytest.raises(InputError, match=r"^film parameter: got nan"):
        regime_shares([0.5, NAN, 4.0])
    assert regime([0.5, np.inf]).tolist() == [0, 3]
    with pytest.raises(InputError, match=r"^roughness: got nan; allowed > 0 m on one flank"):
        film_parameter(1e-6, roughness_1=NAN, roughness_2=1e-6)


def test_a_flow_without_numbers_carries_no_heat(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convection, "_flow", lambda: lambda z: np.full(5, NAN))
    with pytest.raises(ConvergenceError, match=r"^rotating disc, Pr = 3\.25"):
        rotating_disc_gradient(3.25, exponent=2.0)


def test_no_other_law_takes_what_is_not_a_number() -> None:
    with pytest.raises(InputError, match=r"^prandtl: got nan"):
        disc_nusselt(NAN)
    with pytest.raises(InputError, match=r"^peclet: got nan"):
        peclet_factor(NAN)
    with pytest.raises(InputError, match=r"^peclet: got nan"):
        moving_source_rise(0.0, peclet=NAN)
    with pytest.raises(InputError, match=r"^temperature: got nan K"):
        infrared_temperature(NAN, emissivity=0.9, transmission=1.0, surroundings=293.0, path=293.0)
