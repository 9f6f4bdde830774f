"""The server: what it is told at its start, its menu, who asks it, and how it closes."""
