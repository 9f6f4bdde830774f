"""The improve page."""
