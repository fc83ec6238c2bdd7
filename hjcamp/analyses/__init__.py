"""What compare, diagnose, add and calibrate do from paths and names to an answer, on every plant; below commands and notebooks."""
