"""Compiled kernels: flat arrays in, flat arrays out, no objects, no global state."""

from thermogear.dynamics.kernels.fresh import drop_stale

drop_stale()
