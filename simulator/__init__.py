"""TABLETOP: the simulated world, its physics and senses, episodes, and the utak command."""
