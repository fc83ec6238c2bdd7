"""The file of a test log: chunks, messages, samples; how it is scanned, and what can be saved of a damaged one."""
