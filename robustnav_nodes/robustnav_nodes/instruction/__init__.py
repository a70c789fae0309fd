"""Instructions that may be wrong: values, injected errors, models that find them (thesis 4.1)."""
