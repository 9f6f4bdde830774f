"""The workspace and compliance pages."""
