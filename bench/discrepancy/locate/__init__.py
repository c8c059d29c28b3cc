"""Where recorded and simulated differ, with family-wise control."""
