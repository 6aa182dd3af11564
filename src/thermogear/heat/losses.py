"""Losses of a gear pair and its surroundings: mesh, churning, bearings [W]."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.heat.convection import disc_torque


def gear_loss_factor(
    *, teeth_1: ArrayLike, ratio: ArrayLike, approach: ArrayLike, recess: ArrayLike
) -> Floats:
    """Gear loss factor H_V of spur gears under rigid load sharing (Ohlendorf) [-].

    H_V = pi (u+1)/(z1 u) (1 - eps_alpha + eps_1^2 + eps_2^2),  eps_alpha = eps_1 + eps_2.

    ``teeth_1`` z1 of the pinion, ``ratio`` u >= 1, ``recess`` eps_1 = CE/p_b, ``approach`` eps_2
    = AC/p_b [-]. Any shape. The mean over the path of |v_s| times the shared load over the
    transmitted power, exactly, for 1 <= eps_alpha <= 2 with the load halved in double
    contact.

    >>> f"{gear_loss_factor(teeth_1=20, ratio=2.0, approach=0.8, recess=0.8):.4f}"
    '0.1602'
    """
    u, one, two = (np.asarray(a, dtype=float) for a in (ratio, recess, approach))
    bracket = 1.0 - (one + two) + one**2 + two**2
    return np.asarray(np.pi * (u + 1.0) / (np.asarray(teeth_1) * u) * bracket)


def mesh_loss(power: ArrayLike, friction: ArrayLike, loss_factor: ArrayLike) -> Floats:
    """Load-dependent mesh loss P mu H_V [W]; ``power`` transmitted [W], the rest [-].

    >>> f"{mesh_loss(20e3, 0.06, 0.15):.0f} W"
    '180 W'
    """
    return np.asarray(np.asarray(power, dtype=float) * np.abs(friction) * np.asarray(loss_factor))


def churning_loss(
    speed: ArrayLike,
    tip_radius: ArrayLike,
    density: ArrayLike,
    viscosity: ArrayLike,
    immersion: ArrayLike,
) -> Floats:
    """Churning of one dipped gear taken as a smooth disc, omega times :func:`disc_torque` [W].

    ``speed`` omega [rad/s], ``tip_radius`` [m], ``density`` [kg/m^3], ``viscosity`` nu [m^2/s],
    ``immersion`` depth over tip radius 0..2. Any shape. Faces only: a lower bound, teeth and
    splash left out.

    >>> f"{churning_loss(100.0, 84e-3, 870.0, 100e-6, 0.5):.2f} W"
    '22.16 W'
    """
    omega = np.asarray(speed, dtype=float)
    return np.asarray(omega * disc_torque(omega, tip_radius, density, viscosity, immersion))


def bearing_loss(
    force: ArrayLike, bore_diameter: ArrayLike, speed: ArrayLike, coefficient: ArrayLike = 0.0015
) -> Floats:
    """Load-dependent loss of one rolling bearing, mu F (d/2) omega [W].

    ``force`` F [N], ``bore_diameter`` d [m], ``speed`` omega [rad/s], ``coefficient`` mu [-]
    (0.0015 is ours, customary for deep-groove balls; give your maker's). Any shape.

    >>> f"{bearing_loss(2e3, 40e-3, 300.0):.1f} W"
    '18.0 W'
    """
    moment = np.asarray(coefficient) * np.asarray(force, dtype=float) * np.asarray(bore_diameter)
    return np.asarray(0.5 * moment * np.asarray(speed))


def efficiency(*, power: ArrayLike, loss: ArrayLike) -> Floats:
    """1 - loss/power [-]; nan where no power is transmitted.

    >>> f"{efficiency(power=20e3, loss=300.0):.3f}"
    '0.985'
    """
    p, lost = np.broadcast_arrays(np.asarray(power, dtype=float), np.asarray(loss, dtype=float))
    share = np.divide(lost, p, out=np.full(p.shape, np.nan), where=p > 0.0)
    return np.asarray(1.0 - share)
