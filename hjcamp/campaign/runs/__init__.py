"""Find runs, list them, and follow an indicator over them."""
