"""Lubrication, friction, temperature and thermal deformation."""
