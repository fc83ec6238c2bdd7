"""What each effect promises beside a fitted model, and what chance promises as well."""
