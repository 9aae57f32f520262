"""The concealed-effect benchmark: motors whose model lacks something, and a judge of the answers."""
