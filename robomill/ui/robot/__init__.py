"""The robot page."""
