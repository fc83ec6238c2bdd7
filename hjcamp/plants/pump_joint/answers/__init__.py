"""What compare, diagnose, add, calibrate and next do and say for tests of this joint."""
