"""Selection: the mask decides which pixels are traced, and with how many samples.

A mask is an image of weights, 0 to 1. Three steps, one module each, turn the selectors of a project
into samples:

1. *Selectors to weights* (``weights.py``). The selectors of a mask pass (materials, regions, a
   distance, shadow borders …) are evaluated on the position and material that each pixel shows.
   The mask pass (``passes/mask.py``) stores the weights in a texture; shaders can write them too.
2. *Weights to pixels* (``pixels.py``). ``mask.py`` reads the channel of that texture which a
   raytrace pass names; every pixel with a weight above 0 is traced.
3. *Weights to samples* (``samples.py``). With ``weight="spp"`` a pixel gets its share of
   RAYS_PER_PIXEL; otherwise every pixel gets all samples, and shaders blend by the weights.

The pixels then become camera rays: ``passes/raytrace.py`` has the steps of a frame,
``raytrace/tracing/dispatch.py`` the tiles, ``raytrace/kernels/path/camera.py`` the rays.
Everything here is a pure function of arrays; nothing traces a ray or draws.
"""
