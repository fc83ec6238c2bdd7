"""Control laws of this plant: one file each, found by its name."""
