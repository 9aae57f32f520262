"""What on this machine keeps a brick from being reached, and the mend."""
