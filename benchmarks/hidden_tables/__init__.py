"""Hide effects in rigs of the truth plant, and diagnose the tables that their benches print."""
