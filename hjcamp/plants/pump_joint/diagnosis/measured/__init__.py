"""What the logs say: signals, hardware and scatter between repetitions."""
