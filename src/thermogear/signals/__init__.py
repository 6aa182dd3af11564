"""Spectra, filters and lines, for computed and measured records alike."""
