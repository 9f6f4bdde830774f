"""Equations from measurements, fitted, and judged on what was left out."""
