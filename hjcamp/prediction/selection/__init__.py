"""The search for what a model misses: the calibrated base, and the named effects and unknowns that compete beside it."""
