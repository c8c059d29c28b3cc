"""What a diagnosis is worth: corrections learnt from few surveyed links, with and without it."""
