"""Tables, plots, pages and pictures to bytes."""
