"""The record of a study: its rows in SQLite, its plans beside them."""
