"""What a case file holds: schema, units, defaults, and what is varied of it."""
