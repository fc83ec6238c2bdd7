"""Find runs, look at them, hold them against others, take them along."""
