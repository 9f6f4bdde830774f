"""What a person hands on, and who comes by it: a project as an address, as a command and Python, as a report."""
