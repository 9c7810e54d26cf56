"""The parts of tools/dev/mutate."""
