"""The callback of every property. In a module of its own that does not import bpy: Blender 4.2 keeps callbacks past the
end of Python, and one whose module holds bpy makes it crash there."""


def tag_update(_properties, _context):
    """Nothing to do: that there is a callback makes Blender tag the owner as changed."""
