"""From equations to a compiled kernel."""
