"""Files of a build: drawings, meshes, sheets, template, parts list, guide."""
