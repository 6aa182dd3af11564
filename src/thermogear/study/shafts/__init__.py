"""Studies of a gear pair on its shafts: loads and tilts, modes, critical speeds and response."""
