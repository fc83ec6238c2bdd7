"""Tests as they were measured: segments, noise, saturation, replicates, repeatability."""
