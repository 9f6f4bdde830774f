"""What the cutter meets: the engaged part of it, step by step, in the stock as it stands."""
