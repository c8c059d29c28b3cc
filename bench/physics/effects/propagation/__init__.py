"""Effects on paths: what happens to the signal between the antennas."""
