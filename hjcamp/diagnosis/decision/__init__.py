"""What may be said of the tests."""
