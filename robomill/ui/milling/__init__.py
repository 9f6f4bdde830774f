"""The milling page."""
