"""From configuration to test logs: composing, planning, running and the run folder."""
