"""Adapters of the places where shaders can run: Blender's GPU context and a headless one. They draw the same text."""
