"""An identified motor for other programs: URDF, MJCF, Simscape, plain Python."""
