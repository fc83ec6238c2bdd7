"""Logs that belong together, looked at as a set: copies, one that differs from its repetitions, columns that some lack."""
