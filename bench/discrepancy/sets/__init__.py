"""Which set of causes ranges speak for: all are weighed together, by their evidence."""
