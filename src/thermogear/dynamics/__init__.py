"""Equations of motion with a dead zone and the kernels that integrate them."""
