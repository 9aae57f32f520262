"""From folders, globs and URLs to the sessions of a fleet."""
