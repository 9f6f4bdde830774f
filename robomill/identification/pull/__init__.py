"""Where it was pushed and where it was read: load point, gauge point, lines of pull."""
