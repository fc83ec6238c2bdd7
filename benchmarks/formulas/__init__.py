"""How well a formula is found for a curve of a free law: hidden laws on made-up rigs."""
