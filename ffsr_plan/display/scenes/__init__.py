"""What pictures show: sampled motions, outlines and objects of meshcat."""
