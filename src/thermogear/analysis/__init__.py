"""Sections, labels and proofs for any model with a derivative and a period."""
