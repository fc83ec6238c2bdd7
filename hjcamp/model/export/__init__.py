"""A composed model as files for other programs: Python, python-control, FMI, LaTeX."""
