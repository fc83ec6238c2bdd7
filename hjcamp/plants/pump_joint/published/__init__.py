"""What is printed of the joint: values, where a test differs from theirs, the refit, sums that do not agree, slips of the text."""
