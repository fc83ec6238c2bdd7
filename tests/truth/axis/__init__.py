"""A carriage on a belt, and what can hide in it."""
