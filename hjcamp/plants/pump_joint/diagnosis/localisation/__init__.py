"""Where the error comes from, and what it depends on."""
