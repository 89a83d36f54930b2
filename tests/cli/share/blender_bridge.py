"""Runs the add-on in Blender without a window: argv has the add-on, the table and the port."""

import importlib.util, json, sys, time

addon_path, table_path, port = sys.argv[-3:]
spec = importlib.util.spec_from_file_location("ademan_blender", addon_path)
addon = importlib.util.module_from_spec(spec)
sys.modules["ademan_blender"] = addon
spec.loader.exec_module(addon)

import bpy
from mathutils import Euler, Vector


def say(**values):
    print("RESULT", json.dumps(values), flush=True)


def ticks_until(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"timed out: {addon.LINK.receiver and addon.LINK.receiver.state}")
        addon.tick()
        time.sleep(0.01)


def add_rig():
    """A skeleton that is turned, scaled, and hangs its arm: no bone lies along an axis."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    armature.rotation_euler = Euler((0.2, -0.1, 0.6))
    armature.scale = (2, 2, 2)
    bpy.ops.object.mode_set(mode="EDIT")
    bones, parents = armature.data.edit_bones, {}
    rows = [("clavicle", None), ("upper", "clavicle"), ("lower", "upper"), ("hand", "lower")]
    for finger in ("index", "thumb"):
        rows += [(f"{finger}1", "hand"), (f"{finger}2", f"{finger}1"), (f"{finger}3", f"{finger}2")]
    for number, (name, parent) in enumerate(rows):
        bone = bones.new(name)
        bone.parent = bones[parent] if parent else None
        bone.head = bone.parent.tail if parent else Vector((0, 0, 1))
        bone.tail = bone.head + Vector((-1, -0.1 * number, -0.5)) * 0.1
        bone.roll = 0.3 + 0.7 * number
    bones.new("jaw").tail = (0, 0, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    # A pose of a bone that no row moves.
    armature.pose.bones["clavicle"].rotation_quaternion = (0.9, 0.3, 0.1, 0.3)
    bpy.context.view_layer.update()
    return armature


def palm(rig, bone):
    """Returns where the side of a bone now faces that faces down at rest, as the palm in the T pose."""
    world = rig.matrix_world.to_3x3().normalized()
    rest, posed = world @ bone.bone.matrix_local.to_3x3(), world @ bone.matrix.to_3x3().normalized()
    along, down = rest.col[1], Vector((0, 0, -1))
    return list(posed @ rest.transposed() @ (down - along * down.dot(along)).normalized())


addon.register()
say(timer=bpy.app.timers.is_registered(addon.tick))
rig = add_rig()
cube = bpy.data.objects["Cube"]
cube.shape_key_add(name="Basis")
cube.shape_key_add(name="Fist")
settings = bpy.context.scene.ademan
settings.port, settings.table = int(port), table_path

start = time.monotonic()
bpy.ops.ademan.connect()
addon.tick()
say(connect_s=time.monotonic() - start, faults=addon.LINK.table.faults)
ticks_until(lambda: addon.LINK.receiver.received > 100)

# The hand moves the bones and properties. It may rest for a while between two taps.
applied, bends = [], []
apply = addon.Table.apply
addon.Table.apply = lambda table, hand: (apply(table, hand), applied.append(hand.time_us))
end = time.monotonic() + 60
while len(bends) < 25 or (max(bends) - min(bends) < 0.6 and time.monotonic() < end):
    count = len(applied)
    ticks_until(lambda: len(applied) > count)
    bpy.context.view_layer.update()
    bends.append(cube.location.x)
    matrix = rig.matrix_world.to_3x3()
    say(
        time_us=applied[-1],
        bones={bone.name: list((matrix @ (bone.tail - bone.head)).normalized()) for bone in rig.pose.bones},
        palms={bone.name: palm(rig, bone) for bone in rig.pose.bones},
        values={
            "location": cube.location.x,
            "shape": cube.data.shape_keys.key_blocks["Fist"].value,
            "jaw": rig.pose.bones["jaw"].rotation_euler.z,
            "lens": bpy.data.objects["Camera"].data.lens,
            **{name[2:]: cube[name] for name in cube.keys() if name.startswith("c_")},
        },
    )
    time.sleep(0.02)
say(looks=len(bends))
addon.Table.apply = apply

# A recording of one second becomes key frames.
bpy.ops.ademan.record()
ticks_until(lambda: addon.LINK.take.seconds() > 1.0)
bpy.ops.ademan.record()
bpy.context.scene.frame_current = 11
for rate_hz in (50.0, 0.0):
    for animated in (cube, rig, cube.data.shape_keys, bpy.data.objects["Camera"].data):
        animated.animation_data_clear()
    settings.rate_hz = rate_hz
    bpy.ops.ademan.bake()
    ticks_until(lambda: addon.LINK.baking is None)
    curves = {curve.data_path: curve for curve in cube.animation_data.action.fcurves}
    say(
        rate_hz=rate_hz,
        fps=bpy.context.scene.render.fps,
        start_us=addon.LINK.take.hands["right"][0].time_us,
        seconds=addon.LINK.take.seconds(),
        keys=[list(point.co) for point in curves["location"].keyframe_points],
        curves=sorted(curves),
        bone_keys=[len(curve.keyframe_points) for curve in rig.animation_data.action.fcurves],
    )

# The connection is lost, and comes back from a program that counts its time from 0 again.
bpy.ops.ademan.record()
ticks_until(lambda: addon.LINK.take.seconds() > 1.0)
before = len(addon.LINK.take.hands["right"])
say(lose=True)
ticks_until(lambda: addon.LINK.receiver.state.startswith("no connection"))
say(lost=addon.LINK.receiver.state)
received = addon.LINK.receiver.received
ticks_until(lambda: addon.LINK.receiver.received > received + 20)
say(back=addon.LINK.receiver.state, connections=addon.LINK.receiver.connections)
bpy.ops.ademan.record()
times = [hand.time_us for hand in addon.LINK.take.hands["right"]]
say(recorded_after=len(times) - before, in_order=times == sorted(times))

# After an undo, and without a bone that was deleted, the rest of the table goes on.


def apply_after_undo(hand):
    raise ReferenceError("StructRNA of type Object has been removed")


addon.LINK.table.apply = apply_after_undo
ticks_until(lambda: addon.LINK.table is None or addon.LINK.table.apply is not apply_after_undo)
say(after_undo=addon.LINK.table is not None)
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
rig.data.edit_bones.remove(rig.data.edit_bones["index3"])
bpy.ops.object.mode_set(mode="OBJECT")
ticks_until(lambda: addon.LINK.table is None or len(addon.LINK.table.faults) > 4)
count = cube.location.x
ticks_until(lambda: cube.location.x != count)
say(after_deletion=addon.LINK.table.faults[-3:])

# Whole numbers and switches are set as such. A table that fails while it is applied is dropped, and the timer goes on.
rows = [
    {"device": "right", "channel": "wrist.x", "scale": 0, "offset": offset, "target": "Cube", "attribute": attribute}
    for offset, attribute in ((2.6, "pass_index"), (0.7, "hide_viewport"), (0.7, "lock_location.x"))
]
with open(table_path, "w", encoding="utf-8-sig") as file:
    json.dump({"format": "ademan-mapping", "version": 1, "attach": rows}, file)
bpy.ops.ademan.load()
ticks_until(lambda: cube.pass_index == 3)
say(pass_index=cube.pass_index, hidden=cube.hide_viewport, locked=cube.lock_location[0], faults=addon.LINK.table.faults)


def failing(hand):
    raise TypeError("expected an int type")


addon.LINK.table.apply = failing
ticks_until(lambda: addon.LINK.table is None)
say(failed=addon.LINK.message)

# Tables and objects that cannot be used are named.
messages = []
for text in ("[", "{}", '{"format": "ademan-mapping", "version": 9}', '{"format": "ademan-mapping", "version": 1, "bones": 3}'):
    with open(table_path, "w") as file:
        file.write(text)
    bpy.ops.ademan.load()
    messages.append(addon.LINK.message)
say(messages=messages, table=addon.LINK.table is None)
settings.table = ""
bpy.ops.ademan.skeleton()
say(starting_faults=addon.LINK.table.faults)
received = addon.LINK.receiver.received
ticks_until(lambda: addon.LINK.receiver.received > received and bpy.data.objects["Ademan"]["index_bend"] != 0.0)
bpy.data.objects.remove(bpy.data.objects["Ademan"])
ticks_until(lambda: addon.LINK.table is None)
say(removed=addon.LINK.message)

# A receiver that does not read in time loses the oldest lines, and never takes more memory than its queue.
bpy.ops.ademan.connect()
say(disconnected=addon.LINK.receiver is None)
addon.unregister()
say(end=True)
