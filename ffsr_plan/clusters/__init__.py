"""Clusters of Dask workers."""
