"""Passes and the resources between them: dependencies, order, plan, export. Draws nothing."""

from nau_py.graph.plan import Plan, Step, make_plan

__all__ = ["Plan", "Step", "make_plan"]
