"""The HTML pages, from templates and with the explorer of their tests."""
