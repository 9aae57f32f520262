"""What eyes get: the report and its pictures."""
