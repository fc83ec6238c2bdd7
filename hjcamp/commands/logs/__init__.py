"""Test logs: brought in from elsewhere, looked at, judged fit for a diagnosis."""
