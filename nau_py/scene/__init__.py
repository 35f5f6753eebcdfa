"""Models, primitives, materials, cameras and lights: the world that passes draw. No GL, no Embree.
"""
