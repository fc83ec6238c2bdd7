"""Simulations of a compiled model."""
