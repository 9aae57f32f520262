"""Many recordings: tasks on several processes or a cluster, one row a case, and what a fleet has in common."""
