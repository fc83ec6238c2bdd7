"""What may be said of a search, and what speaks against it."""
