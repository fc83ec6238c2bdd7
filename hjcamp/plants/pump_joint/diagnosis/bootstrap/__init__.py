"""Surrogate data with nothing missing, and what a search finds in them."""
