"""The thesis, statement by statement: what it says, what the package computes, the verdict."""
