"""What each candidate would gain to first order, and by chance."""
