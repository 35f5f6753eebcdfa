"""Accuracy against time: knobs, references, metrics, fronts, reports."""
