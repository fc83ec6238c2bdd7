"""What is there before a campaign: the installation, rigs, files that are written by hand."""
