"""What runs the tasks of a study: this process, processes of this computer, or a Dask cluster."""
