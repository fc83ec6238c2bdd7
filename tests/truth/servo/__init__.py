"""A motor that swings a pendulum, alone or over a rope, and what can hide in it."""
