"""What size a joint, a pump and a line must have: the formulas of chapter 3, and what the built joint can do."""
