"""The choices of a mesh model and the quasi-static mesh cycle they lead to."""
