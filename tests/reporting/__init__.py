"""Tests of nau_py.reporting."""
