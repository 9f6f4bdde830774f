"""Set-ups as TOML files, and the tables in them."""
