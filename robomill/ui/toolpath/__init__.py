"""The toolpath page."""
