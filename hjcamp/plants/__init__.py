"""The plants that come along: one file or folder each. Nothing imports this package; `hjcamp.known_plants` finds what is here."""
