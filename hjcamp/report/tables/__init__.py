"""Indicators as tables: declared, aggregated, arranged, compared, and written in each format."""
