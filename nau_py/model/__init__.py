"""What a project file says: one noun a file. Knows neither XML nor YAML, GL nor Embree."""
