"""Shared fixtures: the rig of the thesis, where more than one floor needs it."""
