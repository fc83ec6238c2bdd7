"""A test of any plant on a rig: the loop, its limits and its log; what the rig is stands in the user's file."""
