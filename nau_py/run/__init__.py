"""Running a project: session, active pipeline, frame loop, capture, reload, report.

:class:`~nau_py.run.renderer.Renderer` opens a session; :mod:`nau_py.run.frame_loop` runs the
passes of each frame, :mod:`nau_py.run.capture` reads the picture back, and
:mod:`nau_py.run.report` describes the work.
"""
