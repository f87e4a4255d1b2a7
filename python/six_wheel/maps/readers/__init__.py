"""Forms of maps in files: images through rasterio, text, bags; what is packed, and what is no map."""
