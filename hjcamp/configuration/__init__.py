"""Configuration: where it is looked for, and how the groups are composed into that of one condition."""
