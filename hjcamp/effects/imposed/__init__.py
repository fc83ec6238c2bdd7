"""What an experimenter does to a rig on purpose: a campaign names it, no diagnosis proposes it as missing."""
