"""One step forward, and the verdict."""
