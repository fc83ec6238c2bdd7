"""The water-hydraulic joint, its pump, its controller, its tests, and what can hide in it."""
