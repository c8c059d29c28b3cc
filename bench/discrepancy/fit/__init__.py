"""Parameters of effects, and their intervals."""
