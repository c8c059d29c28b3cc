"""Every table and figure of the paper on any recordings, with the paper's number beside ours."""
