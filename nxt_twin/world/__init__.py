"""Simulated robots in simulated surroundings, standing behind the mock brick."""
