"""Logs for other programs: tables, viewers, models beside what was measured."""
