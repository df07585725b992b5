"""The papers' grid model: regions, generators, the synchronous simulator, studies and pictures."""
