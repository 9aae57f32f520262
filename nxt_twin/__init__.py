"""A digital twin for the LEGO Mindstorms NXT that finds the physics its model leaves out."""

__version__ = "0.1.0"
