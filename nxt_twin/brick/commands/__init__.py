"""The commands of a brick by theme: motors, sensors, files and so on, each over one `Exchange`."""
