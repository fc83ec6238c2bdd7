"""Two tanks in a row, and what can hide in them."""
