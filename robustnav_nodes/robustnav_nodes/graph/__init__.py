"""What the nodes share: base class, parameters, diagnostics, life cycle, start-up of the graph."""
