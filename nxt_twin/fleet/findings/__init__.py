"""What a fleet's table says of its units: what they lack, how they drift, what a batch shares, who stands out."""
