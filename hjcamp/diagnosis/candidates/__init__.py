"""What competes to explain a residual."""
