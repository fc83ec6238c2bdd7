"""Test campaigns for a water-hydraulic servo joint, and the search for what its model misses."""

__version__ = "0.1.0"
