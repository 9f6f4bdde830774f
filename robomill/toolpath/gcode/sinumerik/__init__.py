"""What Sinumerik controls (840D, 828D) say otherwise."""
