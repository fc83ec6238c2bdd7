"""The rig of this joint through NI-DAQmx: wiring, limits, reach, checks before it moves, the loop of a test."""
