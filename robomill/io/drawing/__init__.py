"""Drawings as lines by layer: DXF and SVG."""
