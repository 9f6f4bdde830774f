"""The arm somewhere: where one looks, what pushes there, how far it gives, over a region or at a point."""
