"""From test logs to indicators, tables beside the published values, figures and the report page."""
