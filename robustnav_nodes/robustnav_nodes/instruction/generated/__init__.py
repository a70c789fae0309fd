"""Walks through simulated homes with instructions for them: data to learn from, as much as is wanted."""
