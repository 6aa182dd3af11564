"""REXS: gearbox models read into cases, cases written as models."""
