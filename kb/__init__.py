"""What Utak knows: perception, interpretation, world model and reconciliation. Imports geometry alone."""
