"""States of an edge: unknown, proven free, or refused."""

UNKNOWN, FREE, REFUSED = 0, 1, -1
