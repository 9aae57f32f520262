"""Truth families: simulators of motors that share nothing with the fit, nor with one another."""
