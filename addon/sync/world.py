# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world: what a ray sees that hits nothing."""

from dataclasses import replace

import numpy as np

from ..engine.scene import World
from .compat import node_tree
from .nodes import output_source
from .textures import NodeReader, mapping_matrix
from .values import Value


def read_world(world, scene, images, reports):
    """The engine's World of a Blender world; black without one. An image goes into `scene`, an engine Scene."""
    if world is None:
        return World(color=(0.0, 0.0, 0.0))
    tree = node_tree(world)
    if tree is None:
        return _of(Value(tuple(world.color)))
    reader = NodeReader(f"world {world.name!r}", images, reports, panorama=True)
    read = _read(world, tree, scene, reader)
    reader.finish()
    return read


def _read(world, tree, scene, reader):
    surface = output_source(tree, "Surface")
    volume = output_source(tree, "Volume")
    if volume is not None and volume.node is not None:
        reader.left_out(volume, "its volume")
    if surface is None or surface.node is None:
        return World(color=(0.0, 0.0, 0.0))
    if surface.type not in ("BACKGROUND", "EMISSION"):
        reader.not_understood(surface, "the world's viewport color")
        return _of(Value(tuple(world.color)))
    source = surface.input("Color")
    color = reader.color(source)
    if color.image >= 0:
        color = _oriented(source, color, scene, reader)
    return _of(color.times(reader.number(surface.input("Strength"))))


def _of(value):
    return World(color=tuple(np.maximum(np.nan_to_num(value.rgb), 0.0)), image=value.image)


def _oriented(source, color, scene, reader):
    """The image as its node turns it; what turns it otherwise than about Z is reported."""
    if source.type != "TEX_ENVIRONMENT":
        reader.warn(f"node {source.node.name!r}: its image is rendered as a panorama")
        return color
    if source.node.projection != "EQUIRECTANGULAR":
        reader.warn(
            f"node {source.node.name!r}: mirror ball projection is not rendered, equirectangular is used instead"
        )
    vector = source.input("Vector")
    if vector.node is None or (vector.type == "TEX_COORD" and vector.output.identifier == "Generated"):
        return color
    matrix = mapping_matrix(vector, reader)[:3, :3] if vector.type == "MAPPING" else None
    if matrix is None or not np.allclose(matrix[2], (0.0, 0.0, 1.0), atol=1e-6):
        reader.not_understood(vector, "the image unturned")
        return color
    scene.images[color.image] = _turned(scene.images[color.image], matrix)  # panoramas are the world's alone
    return color


def _turned(image, matrix):
    """The image about Z as a Mapping node with `matrix` (3, 3) turns it, to the nearest column.

    The pixel for direction d is looked up at matrix @ d; u falls as the angle grows: a turn by a moves columns by a.
    """
    angle = np.arctan2(matrix[1, 0], matrix[0, 0])
    columns = round(angle / (2.0 * np.pi) * image.pixels.shape[1])
    return replace(image, pixels=np.roll(image.pixels, columns, axis=1))
