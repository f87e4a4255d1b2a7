"""Text of tables: `dialect` finds encoding, cells and header."""
