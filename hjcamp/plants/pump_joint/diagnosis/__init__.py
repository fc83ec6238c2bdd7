"""Compare a model with measurements, say where it fails, find the effect that is missing, add it, propose the next test."""
