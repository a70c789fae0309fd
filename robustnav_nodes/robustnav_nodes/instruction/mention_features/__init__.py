"""A row of numbers per mention: how it is worded, and what was seen and turned while it was being walked."""
