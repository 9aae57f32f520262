"""Reach a brick: links, discovery, and one method for each of its commands."""
