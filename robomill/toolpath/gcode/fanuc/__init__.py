"""What Fanuc and Haas say otherwise."""
