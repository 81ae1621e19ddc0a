"""Pages: their templates, scripts and style, and how they reach a browser."""
