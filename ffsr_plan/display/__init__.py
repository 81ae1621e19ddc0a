"""Pages, live views and figures."""
