"""A virtual rig of any plant: the simulator one sample at a time, behind the text protocol of a serial line."""
