"""Deciding: task, route, transport and the action cycle. Imports geometry and kb."""
