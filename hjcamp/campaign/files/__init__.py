"""The files of a run folder: its state, lock and provenance."""
