"""Which effects could explain the residuals, from linear responses."""
