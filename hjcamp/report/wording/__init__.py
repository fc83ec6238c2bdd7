"""How a report shows numbers with their units, names, words and equations."""
