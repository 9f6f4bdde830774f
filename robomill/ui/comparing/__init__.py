"""Projects kept and compared: one door to what is kept under a name, and to what stands beside the one in force."""
