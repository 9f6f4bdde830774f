"""Sections of what was cut, with the measures that a gauge has for them."""
