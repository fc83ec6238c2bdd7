"""What a model leaves of the measured tests, window by window."""
