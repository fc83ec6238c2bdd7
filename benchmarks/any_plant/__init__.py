"""Hide effects in machines of tests/truth, import their logs and diagnose them."""
