"""Which effects explain the readings that a baseline leaves unexplained: screened, drafted, settled, weighed."""
