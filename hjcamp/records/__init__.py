"""Test logs: write, read, verify, recover, find and import them."""
