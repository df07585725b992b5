"""Programs that drive robots through Player's protocol, and what they share."""
