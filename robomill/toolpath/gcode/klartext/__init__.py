"""Heidenhain's dialogue (Klartext)."""
