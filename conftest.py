"""Loads the plugin of pytest that collects scenarios, also where Utak is not installed, and the one that tests it."""

pytest_plugins = ["utak_pytest", "pytester"]
