"""Run the command line as ``python -m hjcamp``."""

from hjcamp.cli import main

main()
