"""Figures, pages and moving pictures of flights, in true time."""
