"""Fit unknowns to the residuals, and judge fits on tests that were not used."""
