"""Pictures: how they are drawn, and what is in them."""
