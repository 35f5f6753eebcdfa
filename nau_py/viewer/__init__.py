"""The viewer: a page in a browser that shows a project and steers it.

``desk`` holds what every window sees; ``studio`` renders, in a child process (``child``) that can
be ended and started again; ``server`` speaks HTTP and web sockets with the page in ``page/``.
"""
