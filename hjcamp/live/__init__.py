"""The page of a run in hand: a process of its own serves it on this computer alone, fed through a pipe that may drop."""
