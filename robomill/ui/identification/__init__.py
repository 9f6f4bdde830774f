"""The identification page."""
