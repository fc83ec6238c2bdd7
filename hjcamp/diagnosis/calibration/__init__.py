"""The nominal parameters of a plant, estimated before anything is called missing."""
