"""What models predict of the tests, and what that leaves."""
