"""What others' methods say of the same case files, each by its recipe; none of them reads an answer."""
