"""Tests of nau_py.process."""
