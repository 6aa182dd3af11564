"""Sections, labels and proofs of clearance oscillators, on their event-exact return map."""
