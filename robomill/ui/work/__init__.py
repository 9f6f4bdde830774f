"""Work that takes its time: beside the page, in turns, kept for everyone once it is done."""
