"""The report of a study: tables, pictures, a page, CSV and Parquet."""
