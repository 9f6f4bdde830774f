"""What a gauge would read on the part, and what is said of it."""
