"""Shafts and bearings of a gear pair: elements, assembly, modes, statics and response."""
