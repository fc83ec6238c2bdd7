"""Threads, processes or a cluster that do the work."""
