"""Ways to reach the mock brick: in process, on a pseudo-terminal, over TCP, as a USB device."""
