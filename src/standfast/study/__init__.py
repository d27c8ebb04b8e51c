"""A study: what is fixed, what varies, what is wanted, and how the grid is cut."""
