"""Pictures and pages, drawn from stored results alone."""
