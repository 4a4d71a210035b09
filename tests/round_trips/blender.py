"""Where Blender has the joints of files.

    blender --background --factory-startup --python blender.py -- <jobs.json> <places.json>

jobs.json is a list of {file, rate, frames}: the numbers of some frames. places.json becomes a list of
{joint: [[x, y, z], ...]}: a place in the world for each frame, Y up, metres.
"""
import builtins
import json
import sys

import bpy
import numpy

# Blender 3.4 uses names of NumPy and a mode of files that newer versions lack
numpy.bool = bool
plain_open = builtins.open
builtins.open = lambda file, mode="r", *more, **named: plain_open(file, mode.replace("U", ""), *more, **named)


def places_of(job):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    first = 0
    scene = bpy.context.scene
    scene.render.fps = round(job["rate"])
    scene.render.fps_base = scene.render.fps / job["rate"]
    if job["file"].endswith(".bvh"):
        first = 1  # it begins no earlier
        bpy.ops.import_anim.bvh(filepath=job["file"], global_scale=0.01, axis_forward="-Z", axis_up="Y")
    else:
        bpy.ops.import_scene.gltf(filepath=job["file"])
    rig = next(o for o in scene.objects if o.type == "ARMATURE")
    out = {bone.name: [] for bone in rig.pose.bones}
    for frame in job["frames"]:
        scene.frame_set(first + frame)
        for bone in rig.pose.bones:
            x, y, z = rig.matrix_world @ bone.head
            out[bone.name].append([x, z, -y])
    return out


jobs, places = sys.argv[sys.argv.index("--") + 1:]
with open(jobs, encoding="utf-8") as text:
    results = [places_of(job) for job in json.load(text)]
with open(places, "w", encoding="utf-8") as text:
    json.dump(results, text)
