"""Pictures: each a small function from a stored Dataset to a matplotlib Figure."""
