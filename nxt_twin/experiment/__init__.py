"""Experiments that identify motors and sensors: what to do, what moves things, what to conclude."""
