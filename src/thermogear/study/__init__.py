"""Case files, runs and stored results."""
