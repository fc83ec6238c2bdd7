"""Models against measured tests: compare, diagnose, propose tests, add what is missing, calibrate."""
