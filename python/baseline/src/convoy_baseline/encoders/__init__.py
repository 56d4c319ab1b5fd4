"""What a sensor saw becomes features of the ground around its agent."""
