"""Pictures rendered out of process."""
