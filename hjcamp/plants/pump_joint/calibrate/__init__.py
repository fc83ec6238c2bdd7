"""Chapter 4 from test logs: pump transfer function, dp/dV, leakage, friction, sensors, each with its interval."""
