"""The tour: sample logs of this joint, the steps, and the sealed answer."""
