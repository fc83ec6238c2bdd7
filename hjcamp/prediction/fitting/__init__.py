"""Fits of a model's free parameters, the chapters that judge them, and their intervals."""
