"""Models on blocks that were left out of the fit."""
