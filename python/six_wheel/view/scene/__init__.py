"""The picture: `shapes` are triangles, `stage` light and cameras, `bodies` the rover, `markers` its motion,
`ground` a piece of a map, `meshes` those of a robot description."""
