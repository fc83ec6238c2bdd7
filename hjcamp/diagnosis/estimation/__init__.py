"""Fits, the likelihood, and how well a parameter is known."""
