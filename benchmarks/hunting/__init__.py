"""Hunts on simulated rigs with something hidden, next to as many tests at random and to a full campaign."""
