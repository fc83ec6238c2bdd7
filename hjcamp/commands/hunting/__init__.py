"""A campaign that goes on by itself: its tests are made, diagnosed, and joined by those that separate what remains."""
