"""Plans: the public `plan`, the `Plan` that it returns, and its file."""
