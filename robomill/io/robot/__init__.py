"""Robots as TOML and URDF files."""
