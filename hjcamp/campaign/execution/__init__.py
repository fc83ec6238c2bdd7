"""Make the tests of a plan: here, in processes or on a cluster; their progress and their ends."""
