"""Which measurement next: what separates explanations that recordings cannot tell apart.

Each explanation, with every set of parameters that the recordings leave open, predicts what a
measurement would show; those on which predictions differ most, beside the noise, come first.
"""
