"""Measurements from elsewhere, made into test logs."""
