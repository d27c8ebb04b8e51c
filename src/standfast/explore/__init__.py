"""The page on which one sees a person stand, sway and fall: what it is told, and who answers it."""
