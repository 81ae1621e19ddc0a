"""Measures of pictures that tell a drawing from a blank sheet."""

import numpy as np
from PIL import Image


def colours_and_edges(picture, rows=slice(None)):
    """Number of colours, and the share of pixels that differ clearly from a neighbour."""
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)[rows]
    colours = len(np.unique(pixels.reshape(-1, 3), axis=0))
    steps = np.abs(np.diff(pixels, axis=1)).sum(axis=2) > 60
    return colours, float(steps.mean())
