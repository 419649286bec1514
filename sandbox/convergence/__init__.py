"""Convergence of a scene's expected quantities as the time step is halved twice."""
