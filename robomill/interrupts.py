"""Signals of whoever wants the process to end, whatever became of their exceptions on the way."""

heard: list[int] = []
