"""What has changed between recordings made before and recordings made after: few parameters or effects, or nothing."""
