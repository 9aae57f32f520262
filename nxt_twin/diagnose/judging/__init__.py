"""How sure the answer is: held-out free runs, calibration, intervals, look-alikes, detectable sizes."""
