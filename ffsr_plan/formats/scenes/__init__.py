"""Scenes in the formats of other tools."""
