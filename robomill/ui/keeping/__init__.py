"""Work kept beyond its page: settings, shelf, writer, and what comes back."""
