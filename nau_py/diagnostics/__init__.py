"""Findings: place, severity, message, fixes; the catalogue of rules; reporters.

Imports no other room and knows no project.
"""
