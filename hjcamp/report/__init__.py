"""From test logs to indicators, tables next to the published values, figures and the report page."""
