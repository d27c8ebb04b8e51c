"""Explore: one page in the browser whose formulas are those of the package."""
