"""What the print says of the joint beside itself: sums that do not agree, and slips of the text."""
