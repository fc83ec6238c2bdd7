"""Which test next: the rivals that a diagnosis leaves, simulated on tests that could be made."""
