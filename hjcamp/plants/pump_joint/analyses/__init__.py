"""What compare, diagnose, add and calibrate compute for tests of this joint, from paths and names to an answer."""
