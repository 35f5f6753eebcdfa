"""Models, primitives, materials, cameras, lights: the world that passes draw. No GL or Embree."""
