"""Work kept beyond its page, and projects kept under a name: settings, shelf, writer, what comes back, comparison."""
