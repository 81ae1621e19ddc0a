"""The tasks of a study: what each is, its key, and the row that it ends in."""
