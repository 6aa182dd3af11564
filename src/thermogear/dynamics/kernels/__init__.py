"""Compiled kernels: flat arrays in, flat arrays out, no objects, no global state."""
