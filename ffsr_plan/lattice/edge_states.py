"""What is known of an edge: nothing, proven free, or refused."""

UNKNOWN, FREE, REFUSED = 0, 1, -1
