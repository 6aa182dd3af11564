"""Geometry, contact and stiffness of an isothermal spur gear pair."""
