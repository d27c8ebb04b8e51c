"""The person's body: mass and geometry, measured or scaled from published tables."""
