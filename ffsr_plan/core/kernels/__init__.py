"""Compiled kernels: their compilation by numba, and the machine code on disk."""
