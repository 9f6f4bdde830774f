"""The rules of the language, each stated once: read line by line, and compiled for long programs."""
