"""The next tests: those that separate the rivals best."""
