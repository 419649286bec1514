"""The golden digest: the numbers of every shipped scene and of every whole scene of the docs."""
