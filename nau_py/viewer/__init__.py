"""The viewer: a page in a browser that shows a project and steers it.

``state`` holds the state that every window shares; ``render_thread`` keeps the picture up to date
through ``worker``, a process that can be ended and started again; ``server`` answers the page in
``page/`` by HTTP and web sockets.
"""
