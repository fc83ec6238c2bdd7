"""What is varied: models by name, their unknowns, and states that each test has of its own."""
