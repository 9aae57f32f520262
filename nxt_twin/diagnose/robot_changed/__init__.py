"""What differs between recordings of a robot on two wheels that were made before and after."""
