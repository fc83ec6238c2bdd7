"""Machines of other people, each with a truth of its own and the plant that its user would write."""
