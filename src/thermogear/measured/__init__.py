"""Measured records: read them, name their traps, reduce them to lines with uncertainty."""
