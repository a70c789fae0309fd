"""A simulated person: asks for an object, waits, thanks."""
