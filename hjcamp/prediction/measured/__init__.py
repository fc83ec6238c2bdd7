"""What the logs say by themselves: measured tests, the noise and the ends of their sensors, repetitions, and the floor."""
