"""From the proven path of a plan to a proven smooth curve."""
