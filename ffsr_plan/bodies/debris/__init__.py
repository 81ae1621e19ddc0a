"""Clouds of spheres that drift, and one tree over all of them."""
