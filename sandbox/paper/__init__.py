"""The studies and figures of the paper: what serves its own fingers and hands only."""
