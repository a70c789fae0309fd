"""Detection: objects in the camera image, with places; back ends, and how their errors are dialled."""
