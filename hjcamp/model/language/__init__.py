"""What a plant's equations say: names, units and the places where effects bind."""
