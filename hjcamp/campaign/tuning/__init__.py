"""Search the parameters of a controller on simulated tests, and keep them as a file."""
