"""HTML templates of the pages, with their scripts and style."""
