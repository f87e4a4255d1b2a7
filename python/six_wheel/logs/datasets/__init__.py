"""Layouts of published data sets, from their tools and descriptions; untested on the originals."""
