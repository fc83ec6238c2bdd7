"""How many tests set two rivals apart, as proposed and in random order."""
