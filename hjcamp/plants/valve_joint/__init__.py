"""The joint driven by valves: equations, what its valves do with a duty, and laws for them."""
