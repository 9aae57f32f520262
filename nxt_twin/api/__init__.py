"""The functions behind the names of `nxt_twin` (docs/api.md), and what they share with the command line."""
