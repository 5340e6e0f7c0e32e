"""The oracle's device code: certificates that no pose enters a ray or comes to a point of it, or a pose that does."""
