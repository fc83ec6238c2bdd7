"""Hide effects in rigs of the truth plant, diagnose them, and count how often the diagnosis is right."""
