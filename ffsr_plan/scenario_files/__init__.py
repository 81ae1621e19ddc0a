"""Scenario files in TOML and their schema."""
