"""What is remarked of an answer: of bounds, of what lies outside the library, of what remains, of tests that would decide."""
