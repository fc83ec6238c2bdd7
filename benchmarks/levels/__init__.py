"""Diagnose rigs with other contacts: the levels of the verdict."""
