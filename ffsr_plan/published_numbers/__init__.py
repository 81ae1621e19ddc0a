"""Numbers from publications, recomputed with this package."""
