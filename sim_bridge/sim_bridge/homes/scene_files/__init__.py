"""Scene files: homes as people write them."""
