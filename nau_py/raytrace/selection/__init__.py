"""Where to trace: selectors, weights, pixels, samples a pixel."""
