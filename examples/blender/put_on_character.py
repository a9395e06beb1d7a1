"""Puts a dance that mocaplm wrote (.bvh or .glb) onto a character's armature.

    blender -b --python put_on_character.py -- dance.bvh character.glb --out dancer.glb

DANCE is a .bvh in centimetres or a .glb of `mocaplm convert`, on any of its skeletons. CHARACTER is
a .glb, .gltf, .fbx or .blend with one armature, whose bones are named as those of Mixamo, Unity,
Unreal, VRM, Rokoko, CMU or SMPL; other names go into --map, a JSON file such as
{"hips": "Bip01 Pelvis", "left_upper_leg": "Bip01 L Thigh"} (the parts are the keys of PARTS below).

Every bone turns as the dancer's does, seen from the rest pose of each; arms, legs and hands are first
turned into the directions that the dancer's have at rest, so that a T-pose and an A-pose fit. The
way of the hips is scaled by the length of the legs. Written: a .glb or .blend with the character,
its skin and materials and one action, at the dance's frame rate; --picture draws one frame.
The last line that is printed is a JSON object: parts that were matched, frames, frame rate, and where
the joints lie in some frames (metres, Z up, the dancer faces -Y, its left is +X).
"""

import argparse
import json
import struct
import sys
from pathlib import Path

import bpy
import numpy
from mathutils import Matrix, Quaternion, Vector

# What the programs call the parts of a body, in lower case without separators and prefixes.
# "*" stands for left and right as l, r, left or right, at either end.
PARTS = {
    "hips": "hips pelvis hip",
    "spine1": "spine1 lowerback spine spine01 abdomen",
    "spine2": "spine2 chest spine1 spine02",
    "spine3": "spine3 upperchest spine2 spine03 chest",
    "neck": "neck neck01",
    "head": "head",
    "*_shoulder": "*shoulder *collar *clavicle",
    "*_upper_arm": "*upperarm *arm *shldr",
    "*_lower_arm": "*lowerarm *forearm *elbow",
    "*_hand": "*hand *wrist",
    "*_upper_leg": "*upperleg *upleg *thigh",
    "*_lower_leg": "*lowerleg *leg *calf *shin *knee",
    "*_foot": "*foot *ankle",
    "*_toes": "*toes *toebase *toe *ball",
}
# Whose names say something else than another program's: SMPL's hips are joints of the legs, its
# shoulders those of the arms; the spine is counted in as many ways.
SCHEMES = {
    "smpl": {"hips": "pelvis", "spine1": "spine1", "spine2": "spine2", "spine3": "spine3",
             "*_shoulder": "*collar", "*_upper_arm": "*shoulder", "*_lower_arm": "*elbow",
             "*_hand": "*wrist", "*_upper_leg": "*hip", "*_lower_leg": "*knee",
             "*_foot": "*ankle", "*_toes": "*foot"},
    "mixamo": {"spine1": "spine", "spine2": "spine1", "spine3": "spine2"},
    "unity or vrm": {"spine1": "spine", "spine2": "chest", "spine3": "upperchest"},
    "unreal": {"spine1": "spine01", "spine2": "spine02", "spine3": "spine03"},
    "rokoko": {"spine1": "spine1", "spine2": "spine2", "spine3": "spine3"},
    "cmu": {"spine1": "lowerback", "spine2": "spine", "spine3": "spine1"},
}
NEEDED = ["hips", "head"] + [side + part for side in ("left_", "right_") for part in (
    "upper_arm", "lower_arm", "upper_leg", "lower_leg", "foot")]
# Bones that are laid into the dancer's directions, with the part at their end.
LIMBS = [(side + a, side + b) for side in ("left_", "right_") for a, b in (
    ("upper_arm", "lower_arm"), ("lower_arm", "hand"), ("upper_leg", "lower_leg"),
    ("lower_leg", "foot"))]
SOLE_BELOW_TOES = 0.034  # of mocaplm's figures, metres


# Blender 3.4 was written before Python 3.11 and numpy 1.24, with which Debian 12 has it.
for alias in ("bool", "float", "int", "object"):
    if alias not in vars(numpy):
        setattr(numpy, alias, {"bool": bool, "float": float, "int": int, "object": object}[alias])


def fail(text):
    print("put_on_character: " + text, file=sys.stderr)
    sys.exit(3)


def plain(name):
    name = "".join(c for c in name.rsplit(":", 1)[-1].lower() if c not in "_ -.")
    for prefix in ("mixamorig", "jbipc", "jbip"):  # Mixamo, VRoid's J_Bip_C_ and J_Bip_L_
        if name.startswith(prefix):
            return name[len(prefix):]
    return name


def spelled(pattern, side):
    if "*" not in pattern:
        return [pattern]
    word = pattern.replace("*", "")
    return [side + word, side[0] + word, word + side[0], word + side]


def match(armature, given):
    """Part -> bone's name, by the scheme that knows most of the names."""
    names = {}
    for bone in armature.data.bones:
        names.setdefault(plain(bone.name), bone.name)
    best = {}
    for scheme in SCHEMES.values():
        found = {}
        for part, usual in PARTS.items():
            for side in ("left", "right") if "*" in part else ("",):
                patterns = scheme.get(part, usual).split()
                words = [word for pattern in patterns for word in spelled(pattern, side)]
                bone = next((names[word] for word in words if word in names), None)
                if bone is not None and bone not in found.values():
                    found[part.replace("*", side)] = bone
        if len(found) > len(best):
            best = found
    for part, bone in given.items():
        if bone not in armature.data.bones:
            fail(f'the character has no bone "{bone}", which --map names for {part}')
        best[part] = bone
    missing = [part for part in NEEDED if part not in best]
    if missing:
        fail(f"{armature.name}: no bone was found for {', '.join(missing)} among "
             f"{', '.join(b.name for b in armature.data.bones)}; name them in --map")
    return best


def glb_rate(path):
    """mocaplm writes the frame rate into the animation's extras."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    animations = json.loads(data[20:20 + length]).get("animations", [{}])
    return animations[0].get("extras", {}).get("fps")


def set_rate(scene, rate):
    scene.render.fps = max(1, round(rate))
    scene.render.fps_base = scene.render.fps / rate


def load(path):
    """Imports a file; returns its new objects."""
    before = set(bpy.data.objects)
    ending = path.suffix.lower()
    if not path.exists():
        fail(f"{path}: no such file")
    if ending == ".bvh":
        # Blender 3.4 opens the file in a mode that Python 3.11 no longer has.
        from io_anim_bvh import import_bvh
        import_bvh.open = lambda file, mode="r", **how: open(file, mode.replace("U", ""), **how)
        bpy.ops.import_anim.bvh(filepath=str(path), global_scale=0.01, axis_forward="-Z", axis_up="Y",
                                rotate_mode="QUATERNION", update_scene_fps=True,
                                update_scene_duration=True)
    elif ending in (".glb", ".gltf"):
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif ending == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))
    elif ending == ".blend":
        with bpy.data.libraries.load(str(path)) as (source, target):
            target.objects = source.objects
        for one in target.objects:
            bpy.context.scene.collection.objects.link(one)
    else:
        fail(f"{path}: expected .bvh, .glb, .gltf, .fbx or .blend")
    return [one for one in bpy.data.objects if one not in before]


def armature_of(objects, path):
    armatures = [one for one in objects if one.type == "ARMATURE"]
    if not armatures:
        fail(f"{path}: holds no armature")
    return max(armatures, key=lambda one: len(one.data.bones))


def rest_world(armature, bone):
    return armature.matrix_world @ armature.data.bones[bone].matrix_local


def turn_of(matrix):
    return matrix.to_quaternion().normalized()


class Figure:
    """An armature, its bones by part, and how it stands at rest, in the world."""

    def __init__(self, armature, parts):
        self.armature, self.parts = armature, parts
        self.rest = {part: rest_world(armature, bone) for part, bone in parts.items()}

    def at_rest(self, part):
        return self.rest[part].translation

    def direction(self, a, b):
        return (self.at_rest(b) - self.at_rest(a)).normalized()

    def leg(self):
        return sum((self.at_rest(s + a) - self.at_rest(s + b)).length for s in ("left_", "right_")
                   for a, b in (("upper_leg", "lower_leg"), ("lower_leg", "foot"))) / 2

    def ankle(self):
        return (self.at_rest("left_foot").z + self.at_rest("right_foot").z) / 2

    def facing(self):
        """The turn about Z that brings this figure's left to +X."""
        left = self.at_rest("left_upper_leg") - self.at_rest("right_upper_leg")
        return Vector((left.x, left.y, 0)).rotation_difference(Vector((1, 0, 0)))

    def world(self):
        return {part: self.armature.matrix_world @ self.armature.pose.bones[bone].matrix
                for part, bone in self.parts.items()}


def corrections(dancer, character):
    """For each part the turn that lays the character's limb as the dancer's lies at rest; and the
    turn from where the dancer faces at rest to where the character does."""
    front = character.facing().inverted() @ dancer.facing()
    turns = {part: Quaternion() for part in character.parts}
    for a, b in LIMBS:
        if all(part in figure.parts for part in (a, b) for figure in (dancer, character)):
            turns[a] = character.direction(a, b).rotation_difference(
                front @ dancer.direction(a, b))
    for side in ("left_", "right_"):
        if side + "hand" in turns:
            turns[side + "hand"] = turns[side + "lower_arm"]
    return turns, front


def sole_height(character, objects):
    """The lowest point of the meshes at rest, else the floor."""
    lows = [(one.matrix_world @ Vector(corner)).z for one in objects if one.type == "MESH"
            for corner in one.bound_box]
    return min(lows) if lows else 0.0


def retarget(dancer, character, ground, first, last):
    """The rotations of every mapped bone, and the way of the hips, as an action."""
    armature = character.armature
    turns, front = corrections(dancer, character)
    scale = character.leg() / dancer.leg()
    ankle = dancer.ankle() - min(dancer.at_rest(s + "toes").z for s in ("left_", "right_"))
    lift = character.ankle() - ground - scale * (ankle + SOLE_BELOW_TOES)
    part_of = {bone: part for part, bone in character.parts.items() if part in dancer.parts}
    into = armature.matrix_world.inverted()
    armature_turn = turn_of(armature.matrix_world)
    bones = []
    for bone in armature.data.bones:  # parents come first
        local = bone.parent.matrix_local.inverted() @ bone.matrix_local if bone.parent else \
            bone.matrix_local
        bones.append((bone.name, bone.parent.name if bone.parent else None, local))
    keys = {bone: [] for bone in part_of}
    places, scene = [], bpy.context.scene
    for frame in range(first, last + 1):
        scene.frame_set(frame)
        moved, posed = dancer.world(), {}
        for name, parent, local in bones:
            matrix = (posed[parent] if parent else Matrix()) @ local
            part = part_of.get(name)
            if part:
                turn = turn_of(moved[part]) @ turn_of(dancer.rest[part]).inverted()
                turn = front @ turn @ front.inverted()  # where the character faces
                wanted = turn @ turns[part] @ turn_of(character.rest[part])
                wanted = armature_turn.inverted() @ wanted
                basis = turn_of(matrix).inverted() @ wanted
                if keys[name] and basis.dot(keys[name][-1]) < 0:
                    basis.negate()
                keys[name].append(basis)
                place = matrix.translation
                if part == "hips":
                    place = front @ (moved[part].translation * scale)
                    place.z += lift + ground
                    place = into @ place
                    places.append((matrix.to_quaternion().inverted() @
                                   (place - matrix.translation)))
                matrix = Matrix.LocRotScale(place, turn_of(matrix) @ basis, matrix.to_scale())
            posed[name] = matrix
    action = bpy.data.actions.new("dance")
    armature.animation_data_create().action = action

    def curve(path, index, values):
        points = action.fcurves.new(path, index=index)
        points.keyframe_points.add(len(values))
        points.keyframe_points.foreach_set(
            "co", [x for i, value in enumerate(values) for x in (first + i, value)])
        for point in points.keyframe_points:
            point.interpolation = "LINEAR"

    for name, values in keys.items():
        bone = armature.pose.bones[name]
        bone.rotation_mode = "QUATERNION"
        for index in range(4):
            curve(bone.path_from_id("rotation_quaternion"), index, [q[index] for q in values])
        if part_of[name] == "hips":
            for index in range(3):
                curve(bone.path_from_id("location"), index, [p[index] for p in places])
    return part_of


def draw(path, character, frame):
    """One frame from the front, on the processor: no display is needed."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    at = character.world()["hips"].translation
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler, sun.data.energy = (0.8, 0.2, 0.3), 4
    size = 2.6 * character.leg()
    camera.location = at + Vector((0, -1.7 * size, 0.05 * size))
    camera.rotation_euler = (1.5, 0, 0)
    for one in (camera, sun):
        scene.collection.objects.link(one)
    scene.camera = camera
    scene.world = scene.world or bpy.data.worlds.new("world")
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 16
    scene.cycles.use_denoising = False  # Debian's Blender comes without a denoiser
    scene.render.resolution_x, scene.render.resolution_y = 480, 480
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser(prog="put_on_character")
    parser.add_argument("dance", type=Path)
    parser.add_argument("character", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--map", type=Path)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--picture-frame", type=int)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    if options.out.suffix.lower() not in (".glb", ".blend"):
        fail(f"{options.out}: expected .glb or .blend")
    given = json.loads(options.map.read_text()) if options.map else {}

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    if options.dance.suffix.lower() == ".glb" and options.dance.exists():
        rate = glb_rate(options.dance)
        if rate:
            set_rate(scene, rate)
    dance_objects = load(options.dance.absolute())
    dance = armature_of(dance_objects, options.dance)
    action = dance.animation_data and dance.animation_data.action
    if not action:
        fail(f"{options.dance}: holds no motion")
    first, last = round(action.frame_range[0]), round(action.frame_range[1])
    character_objects = load(options.character.absolute())
    armature = armature_of(character_objects, options.character)
    for track in list(armature.animation_data.nla_tracks) if armature.animation_data else []:
        armature.animation_data.nla_tracks.remove(track)
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.matrix_basis = Matrix()
    armature.data.pose_position = "REST"
    bpy.context.view_layer.update()
    dancer = Figure(dance, match(dance, {}))
    character = Figure(armature, match(armature, given))
    ground = sole_height(character, character_objects)
    armature.data.pose_position = "POSE"
    parts = retarget(dancer, character, ground, first, last)
    scene.frame_start, scene.frame_end = first, last

    report = {"parts": {part: bone for bone, part in parts.items()}, "frames": last - first + 1,
              "fps": scene.render.fps / scene.render.fps_base, "scale": character.leg() / dancer.leg(),
              "joints": {}}
    for frame in sorted({first, (first + last) // 2, last}):
        scene.frame_set(frame)
        report["joints"][frame - first] = {
            part: list(matrix.translation) for part, matrix in character.world().items()}
    for one in dance_objects:
        bpy.data.objects.remove(one)
    if options.picture:
        draw(options.picture.absolute(), character,
             first if options.picture_frame is None else first + options.picture_frame)
    for unused in [a for a in bpy.data.actions if a.users == 0]:
        bpy.data.actions.remove(unused)
    if options.out.suffix.lower() == ".blend":
        bpy.ops.wm.save_as_mainfile(filepath=str(options.out.absolute()))
    else:
        bpy.ops.export_scene.gltf(filepath=str(options.out.absolute()), export_format="GLB")
    print(json.dumps(report))


main()
