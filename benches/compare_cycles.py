"""The natural look beside Cycles: seconds to the same noise, on the same mesh, camera, sun and sky.

    pip install bpy openimageio && LICHTENBERG=target/release/lichtenberg python3.11 benches/compare_cycles.py [SCENE] [WIDTH] [REFERENCE]

SCENE is grown with `skin = "mesh"` in the studio stage, on a round ground; Cycles gets its triangles, its colour, the ground, a sun of
the same size and a sky of one colour. Noise is what is off a picture of REFERENCE samples (4,096) of the same program, as a root mean square of
values that are shown (0 to 1, gamma 2.2). Both denoise, as they do by default: Cycles by Open Image Denoise. Times are of rendering
alone: of Lichtenberg the whole call less that of a picture of 16 by 16 pixels, which grows as much; of Cycles from the scene on.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy
import OpenImageIO

LICHTENBERG = os.environ.get("LICHTENBERG", "target/release/lichtenberg")
SCENE = sys.argv[1] if len(sys.argv) > 1 else "elm"
WIDTH = int(sys.argv[2]) if len(sys.argv) > 2 else 200
REFERENCE = int(sys.argv[3]) if len(sys.argv) > 3 else 4096
SIZE = (WIDTH, WIDTH * 3 // 4)
SAMPLES = [2, 4, 8, 16, 32, 64, 128]
SUN = (-0.5, -0.8, 0.8)
COLOUR = (0.55, 0.45, 0.35)
GROUND = (0.6, 0.55, 0.5)
RADIUS = 60


def colour(values):
    return "[" + ", ".join(f"{x:.4f}" for x in values) + "]"


# Lit alike: a sun, and a sky of one colour from all sides, below the horizon too.
CHANGES = [
    "stage=studio",
    f'object.{SCENE}.skin="mesh"',
    "sky={ colour = [0.5, 0.55, 0.6] }",
    f"light.sun.sun={{ from = {colour(SUN)}, colour = [1.0, 0.95, 0.85], size = 3 }}",
    f"material.bark={{ colour = {colour(COLOUR)}, diffuse = 0.8 }}",
    f"ground={{ colour = {colour(GROUND)}, radius = {RADIUS} }}",
    'look="natural"',
]


def call(*arguments):
    changes = [part for change in CHANGES for part in ("--set", change)]
    subprocess.run([LICHTENBERG, *arguments, *changes], check=True, capture_output=True)


def read(path):
    pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.FLOAT)[:, :, :3]
    return numpy.clip(pixels, 0.0, 1.0) ** (1 / 2.2)


def ours(folder, samples, size=SIZE):
    path = folder / f"ours-{samples}-{size[0]}.exr"
    start = time.perf_counter()
    call("render", SCENE, "--samples", str(samples), "--size", f"{size[0]}x{size[1]}", "-o", str(path))
    return time.perf_counter() - start, path


def matt(name, values):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*(0.8 * x for x in values), 1)
    material.node_tree.links.new(diffuse.outputs[0], output.inputs[0])
    return material


def build(folder):
    """The scene in Cycles."""
    call("export", SCENE, "--to", "ply", "--name", "it", "-o", str(folder))
    call("export", SCENE, "--to", "pov", "--name", "it", "--size", f"{SIZE[0]}x{SIZE[1]}", "-o", str(folder))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.wm.ply_import(filepath=str(folder / "it.ply"), forward_axis="Y", up_axis="Z")
    bpy.context.object.data.materials.append(matt("bark", COLOUR))
    bpy.ops.mesh.primitive_circle_add(vertices=128, radius=RADIUS, fill_type="NGON")
    bpy.context.object.data.materials.append(matt("ground", GROUND))
    text = (folder / "it.pov").read_text()
    # Left-handed, y up.
    place = lambda name: [float(x) for x in re.search(name + r" <([^>]*)>", text)[1].split(",")]
    (x, z, y), (a, c, b) = place("location"), place("look_at")
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    from mathutils import Vector

    camera.location = (x, y, z)
    camera.rotation_euler = (Vector((a, b, c)) - Vector((x, y, z))).to_track_quat("-Z", "Y").to_euler()
    camera.data.angle_x = math.radians(float(re.search(r"angle ([\d.]+)", text)[1]))
    scene.camera = camera
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = math.pi * 1.6
    sun.data.color = (1.0, 0.95, 0.85)
    sun.data.angle = math.radians(3)
    sun.rotation_euler = Vector(SUN).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.5, 0.55, 0.6, 1)
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.threads_mode = "AUTO"
    cycles = scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = 6
    cycles.use_denoising = True
    cycles.use_adaptive_sampling = True
    return scene


def theirs(scene, folder, samples):
    path = folder / f"theirs-{samples}.exr"
    scene.cycles.samples = samples
    # What it is measured by has other numbers.
    scene.cycles.seed = int(samples == REFERENCE)
    scene.render.filepath = str(path)
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    return time.perf_counter() - start, path


def curve(name, render, start):
    """Seconds and noise for each number of samples."""
    truth = read(render(REFERENCE)[1])
    found = []
    for samples in SAMPLES:
        seconds, path = min((render(samples) for _ in range(3)), key=lambda run: run[0])
        noise = float(numpy.sqrt(((read(path) - truth) ** 2).mean()))
        found.append((max(seconds - start, 1e-3), noise))
        print(f"| {name} | {samples} | {found[-1][0]:.2f} | {noise:.4f} |", flush=True)
    return found


def seconds_at(found, noise):
    """Seconds to this noise, between the two numbers of samples about it (both logarithmic)."""
    for (t0, e0), (t1, e1) in zip(found, found[1:]):
        if e0 >= noise > e1:
            share = math.log(e0 / noise) / math.log(e0 / e1)
            return t0 * (t1 / t0) ** share
    return None


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"{SCENE}, {SIZE[0]}x{SIZE[1]}, off {REFERENCE} samples; Blender {bpy.app.version_string}")
        print("| program | samples | seconds | noise |\n|---|---|---|---|")
        start = min(ours(folder, 1, (16, 16))[0] for _ in range(3))
        mine = curve("Lichtenberg", lambda samples: ours(folder, samples), start)
        scene = build(folder)
        cycles = curve("Cycles", lambda samples: theirs(scene, folder, samples), 0.0)
        print("\n| noise | Lichtenberg | Cycles | ratio |\n|---|---|---|---|")
        for noise in sorted({e for _, e in mine + cycles}, reverse=True):
            a, b = seconds_at(mine, noise), seconds_at(cycles, noise)
            if a and b:
                print(f"| {noise:.4f} | {a:.2f} s | {b:.2f} s | {b / a:.2f} |")


main()
