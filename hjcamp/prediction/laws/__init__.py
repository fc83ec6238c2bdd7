"""Unknowns: laws without a form, where a plant can have them, and which named laws they stand for."""
