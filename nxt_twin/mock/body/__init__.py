"""The brick's body: battery, motors and sensors, as the firmware's hardware."""
