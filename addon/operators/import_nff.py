# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Import > Neutral File Format: scenes of the Standard Procedural Databases as Blender's objects."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, CollectionProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ..engine.errors import SceneError
from ..engine.nff import read_nff
from ..wording import counted
from . import nff_scene
from .nff_materials import Materials
from .nff_shapes import Shapes

#: Blender's smallest picture.
_SMALLEST_SIDE = 4


class IMPORT_SCENE_OT_nff(ImportHelper, bpy.types.Operator):
    """Import scenes in the Neutral File Format, with exact spheres, cylinders and cones"""

    bl_idname = "import_scene.nff"
    bl_label = "Import NFF"
    bl_options = {"REGISTER", "UNDO", "PRESET"}

    filename_ext = ".nff"
    filter_glob: StringProperty(default="*.nff", options={"HIDDEN"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE", "SKIP_PRESET"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE", "SKIP_PRESET"})

    use_camera: BoolProperty(
        name="Camera", description="Import the view as a camera, and look through it", default=True
    )
    use_resolution: BoolProperty(
        name="Resolution", description="Give the scene's renders the size of the file's picture", default=True
    )
    use_lights: BoolProperty(name="Lights", description="Import the lights", default=True)
    use_falloff: BoolProperty(
        name="Light Fall-Off",
        description="Let the lights fade with the square of the distance. The lights of the file do not fade, "
        "and get a Light Falloff node. Both are equally bright in the middle of the scene",
        default=False,
    )
    use_background: BoolProperty(name="Background", description="Import the background as the world", default=True)
    object_limit: IntProperty(
        name="Objects Up To",
        description="Of one material, this many spheres, cylinders or cones become an object each. "
        "More become one object: a point cloud, or instances",
        default=200,
        min=0,
        soft_max=10000,
    )

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.scene.is_editable

    def invoke(self, context, _event):
        return self.invoke_popup(context)

    def execute(self, context):
        directory = bpy.path.abspath(self.directory)
        paths = [Path(directory, file.name) for file in self.files if file.name]
        paths = paths or [Path(bpy.path.abspath(self.filepath))]
        try:
            files = [read_nff(path) for path in paths]  # all of them before anything is made
        except SceneError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for obj in context.selected_objects:
            obj.select_set(False)
        for number, (path, file) in enumerate(zip(paths, files, strict=True)):
            self._add(context, path.stem, file, is_first=number == 0)
        return {"FINISHED"}

    def _add(self, context, stem, file, is_first):
        """Put a file into the scene, in a collection of its own. The first file's view and background are the
        scene's."""
        collection = bpy.data.collections.new(stem)
        shapes = Shapes(collection, Materials(file.scene.materials, stem), self.object_limit)
        shapes.add(file)
        box = nff_scene.bounds(file.scene)
        if self.use_lights:
            for light in file.scene.lights:
                collection.objects.link(nff_scene.new_light("Light", light, box, self.use_falloff))
        if self.use_camera:
            camera = nff_scene.new_camera("Camera", file.scene.camera, box)
            collection.objects.link(camera)
        # Linked last: objects in the scene are sorted into its view layers one by one.
        context.scene.collection.children.link(collection)
        if is_first:
            if self.use_camera:
                context.scene.camera = camera
            if self.use_background:
                nff_scene.set_world(context.scene, stem, file.scene.world)
            if self.use_resolution:
                self._set_resolution(context.scene.render, file)
        for obj in collection.objects:
            obj.select_set(True)
        self._tell(stem, file, shapes)

    def _set_resolution(self, render, file):
        render.resolution_x, render.resolution_y = (max(side, _SMALLEST_SIDE) for side in (file.width, file.height))
        render.resolution_percentage = 100
        render.pixel_aspect_x = render.pixel_aspect_y = 1.0
        if min(file.width, file.height) < _SMALLEST_SIDE:
            self.report({"WARNING"}, f"The picture of {file.width} x {file.height} pixels is too small for Blender")

    def _tell(self, stem, file, shapes):
        """Report what was made, and what is not as in the file."""
        counts = file.scene.primitive_counts()
        counts.pop("triangle", None)
        counts["polygon"] = sum(map(len, file.polygons))
        counts["light"] = len(file.scene.lights) if self.use_lights else 0
        told = ", ".join(counted(count, kind) for kind, count in counts.items() if count)
        if counts["light"]:
            told += "; the lights "
            told += "are as bright as in the file in the middle of the scene" if self.use_falloff else "do not fade"
        self.report({"INFO"}, f"{stem}: {told or 'nothing but a view'}")
        if shapes.inside_only:
            self.report(
                {"WARNING"},
                f"{stem}: {shapes.inside_only} shapes with a negative radius are meshes that are seen from inside only",
            )


class IMPORT_SCENE_FH_nff(bpy.types.FileHandler):
    """Files dropped into the 3D viewport"""

    bl_idname = "IMPORT_SCENE_FH_nff"
    bl_label = "NFF"
    bl_import_operator = IMPORT_SCENE_OT_nff.bl_idname
    bl_file_extensions = IMPORT_SCENE_OT_nff.filename_ext

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type in {"VIEW_3D", "OUTLINER"}


def draw_entry(self, _context):
    """The entry in File > Import."""
    self.layout.operator(IMPORT_SCENE_OT_nff.bl_idname, text="Neutral File Format (.nff)")


_register_classes, _unregister_classes = bpy.utils.register_classes_factory((IMPORT_SCENE_OT_nff, IMPORT_SCENE_FH_nff))


def register():
    _register_classes()
    bpy.types.TOPBAR_MT_file_import.append(draw_entry)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(draw_entry)
    _unregister_classes()
