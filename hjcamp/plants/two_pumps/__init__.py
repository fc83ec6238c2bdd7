"""The joint with two pumps: equations, the delays of its pumps, and laws for them."""
