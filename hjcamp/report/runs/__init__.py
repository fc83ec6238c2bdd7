"""What the logs of a run say: their origin and settings, the indicators of each test, the spread of a condition."""
