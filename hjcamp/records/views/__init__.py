"""Logs for other programs: tables, viewers, models next to what was measured."""
