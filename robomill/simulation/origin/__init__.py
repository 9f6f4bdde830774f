"""Where the numbers of a set-up come from, and what is doubted of them."""
