"""The problem set: problems as data files, with the best plans known for them."""
