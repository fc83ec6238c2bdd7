"""Answers: a comparison, a diagnosis, an added effect."""
