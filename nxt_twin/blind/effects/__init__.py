"""What can be concealed from a diagnosis, and in what sizes."""
