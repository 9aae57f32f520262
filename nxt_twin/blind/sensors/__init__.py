"""Concealed effects of sensors: readings made by mechanisms of their own, not by the likelihoods that are fitted."""
