"""The world that passes draw, at a moment: models, materials, cameras, lights. No GL or Embree.

1. ``readers`` load model files; ``primitives`` make Nau's built-in meshes.
2. ``build`` turns a ``<scene>`` element into objects (``mesh``).
3. ``material`` and ``mapping`` find the material that a pass draws an object with.
4. ``world`` holds all of it, with cameras, lights and what ``events`` move.
"""
