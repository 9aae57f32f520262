"""Concealed robots: worlds made by seed, solved and scored."""
