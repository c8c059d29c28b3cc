"""Many networks of one architecture trained at once, each as it would have been alone."""
