"""Camera, film, packets of paths and the loop over them."""
