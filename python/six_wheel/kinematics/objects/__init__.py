"""What all objects share: short text, tables of their columns."""
