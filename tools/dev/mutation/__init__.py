"""Modules of tools/dev/mutate."""
