"""Flights past bodies that move, tried until one is proven."""
