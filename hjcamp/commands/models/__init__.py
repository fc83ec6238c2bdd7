"""What can be modelled: plants, effects, their words, and a model as one file."""
