"""The small objects that stand and hang in homes: one file per theme, and the catalogue of all classes."""
