"""One known ground in many forms, and the class of what comes of reading each."""
