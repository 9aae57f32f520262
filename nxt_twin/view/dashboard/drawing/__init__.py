"""The only room of the house that imports rerun; it runs in the dashboard's own process."""
