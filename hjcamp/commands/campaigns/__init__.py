"""Plan, run, resume and tune a campaign."""
