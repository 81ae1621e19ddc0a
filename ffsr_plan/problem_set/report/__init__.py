"""Judged results compared: tables, profiles and one page."""
