"""What is left of the part: stock, height map, groove sections, engagement, error and its metrology."""
