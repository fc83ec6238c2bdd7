"""Whether a change of the code's structure has moved any result: twelve sets of logs, diagnosed by two versions of the code."""
