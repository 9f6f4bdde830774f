"""How good a cut is, and what that rests on: the verdict, the bar on top, bands, evidence, the mathematics behind."""
