"""Shared by all objects: short text, tables of their columns."""
