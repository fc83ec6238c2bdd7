"""Measurement less model: replay of the tests, and residuals as features."""
