PARTS = ("proximal", "intermediate", "distal")
FINGERS = {"index": "index-finger", "middle": "middle-finger", "ring": "ring-finger", "little": "pinky-finger"}

# The joint at the far end of the bone that begins at each joint.
BONE_ENDS = {
    "shoulder": "elbow",
    "elbow": "wrist",
    "thumb-metacarpal": "thumb-phalanx-proximal",
    "thumb-phalanx-proximal": "thumb-phalanx-distal",
    "thumb-phalanx-distal": "thumb-tip",
}
# The hinges: channel, joint, the joint before it, and the axis.
HINGES = [
    ("forearm-supination", "elbow", "shoulder", "x"),
    ("wrist-deviation", "wrist", "elbow", "y"),
    ("wrist-flexion", "wrist", "elbow", "z"),
    ("thumb-cmc-abduction", "thumb-metacarpal", "wrist", "y"),
    ("thumb-cmc-flexion", "thumb-metacarpal", "wrist", "z"),
    ("thumb-mcp-flexion", "thumb-phalanx-proximal", "thumb-metacarpal", "z"),
    ("thumb-ip-flexion", "thumb-phalanx-distal", "thumb-phalanx-proximal", "z"),
]
for short, finger in FINGERS.items():
    phalanges = [f"{finger}-phalanx-{part}" for part in PARTS]
    BONE_ENDS.update(zip(phalanges, [*phalanges[1:], f"{finger}-tip"]))
    HINGES.append((f"{short}-mcp-abduction", phalanges[0], "wrist", "y"))
    HINGES.append((f"{short}-mcp-flexion", phalanges[0], "wrist", "z"))
    HINGES.append((f"{short}-pip-flexion", phalanges[1], phalanges[0], "z"))
    HINGES.append((f"{short}-dip-flexion", phalanges[2], phalanges[1], "z"))

# From the frame of Ademán (X right, Y up, -Z forward) to the frame of Blender (Y forward, Z up).
BLENDER_FROM_WORLD = Matrix(((1, 0, 0), (0, 0, -1), (0, 1, 0)))


class Hand:
    """The pose of one arm and hand, in the axes of Blender: X right, Y forward, Z up, metres."""

    def __init__(self, line=None):
        if line is None:
            return
        self.time_us, self.side = int(line["time_us"]), line["side"]
        self.positions = {name: Vector((x, -z, y)) for name, (x, y, z) in line["positions"].items()}
        self.orientations = {
            name: Quaternion((w, x, -z, y)) for name, (x, y, z, w) in line["orientations"].items()
        }

    def between(self, later, fraction):
        """Returns the pose at a fraction of the way to a later one."""
        hand = Hand()
        hand.time_us, hand.side = self.time_us + fraction * (later.time_us - self.time_us), self.side
        both = lambda mine, others: [(name, mine[name], others[name]) for name in mine if name in others]
        hand.positions = {n: a.lerp(b, fraction) for n, a, b in both(self.positions, later.positions)}
        hand.orientations = {n: a.slerp(b, fraction) for n, a, b in both(self.orientations, later.orientations)}
        return hand

    def channels(self):
        """Returns the values of all channels by name: angles in radians, positions in metres."""
        values = {}
        for joint, position in self.positions.items():
            values.update({f"{joint}.{axis}": getattr(position, axis) for axis in "xyz"})
        for joint in self.orientations:
            euler = self.frame(joint).to_euler("XYZ")
            values.update({f"{joint}.r{axis}": getattr(euler, axis) for axis in "xyz"})
        mirror = -1.0 if self.side == "left" else 1.0
        for channel, joint, before, axis in HINGES:
            if joint not in self.orientations or before not in self.orientations:
                continue
            turn = self.frame(before).transposed() @ self.frame(joint)
            # R = Ry Rz Rx. A mirrored arm turns about X and Y in the other sense.
            values[channel] = {
                "x": mirror * math.atan2(-turn[1][2], turn[1][1]),
                "y": mirror * math.atan2(-turn[2][0], turn[0][0]),
                "z": math.atan2(turn[1][0], math.hypot(turn[1][1], turn[1][2])),
            }[axis]
        upper_arm = self.bone("shoulder")
        if upper_arm and "elbow" in self.orientations:
            forearm = self.frame("elbow").col[0]
            values["elbow-flexion"] = math.atan2(upper_arm.cross(forearm).length, upper_arm.dot(forearm))
        return values

    def frame(self, joint):
        """Returns the axes of a joint: X along the bone, Y to the palm side, Z across."""
        return self.orientations[joint].to_matrix() @ BLENDER_FROM_WORLD

    def bone(self, joint):
        """Returns the direction of the bone that begins at a joint; None if it is not known."""
        if joint == "wrist":
            knuckles = [f"{FINGERS[name]}-phalanx-proximal" for name in ("middle", "index", "little")]
            if knuckles[0] in self.positions:
                end = self.positions[knuckles[0]]
            elif knuckles[1] in self.positions and knuckles[2] in self.positions:
                end = (self.positions[knuckles[1]] + self.positions[knuckles[2]]) / 2
            else:
                return None
        else:
            end = self.positions.get(BONE_ENDS.get(joint))
        start = self.positions.get(joint)
        if start is None or end is None or (end - start).length < 1e-4:
            return None
        return (end - start).normalized()

    def bones(self):
        """Returns the axes of the bones by the joint at which they begin: X along the bone, Y to the palm side."""
        bones = {}
        palm = self.palm()
        along = self.bone("wrist")
        if palm is None:
            return bones
        for joint in ["wrist", "elbow", *[it for it in BONE_ENDS if it not in ("shoulder", "elbow")]]:
            direction = self.bone(joint)
            if direction is not None:
                bones[joint] = axes(direction, along.rotation_difference(direction) @ palm)
        upper_arm = self.bone("shoulder")
        if upper_arm is not None and "elbow" in bones:
            forearm = bones["elbow"].col[0]
            hinge = forearm.cross(upper_arm) * (-1.0 if self.side == "left" else 1.0)
            carried = forearm.rotation_difference(upper_arm) @ bones["elbow"].col[1]
            # The elbows of some arm models swing to the other side.
            if hinge.dot(carried) < -0.5 * hinge.length:
                hinge.negate()
            # The plane of a straight arm is noise.
            weight = min(max((hinge.length - 0.05) / 0.15, 0.0), 1.0)
            bones["shoulder"] = axes(upper_arm, hinge.normalized() * weight + carried * (1.0 - weight))
        return bones

    def palm(self):
        """Returns the direction that the palm faces; None without knuckles."""
        along = self.bone("wrist")
        index, little = (self.positions.get(f"{FINGERS[name]}-phalanx-proximal") for name in ("index", "little"))
        if along is None or index is None or little is None or (index - little).length < 1e-4:
            return None
        palm = (index - little).cross(along) * (-1.0 if self.side == "left" else 1.0)
        return palm.normalized()


def axes(along, palm):
    """Returns the rotation whose X is `along` and whose Y is as near to `palm` as possible."""
    palm = palm - along * palm.dot(along)
    if palm.length < 1e-6:
        palm = along.orthogonal()
    palm = palm.normalized()
    return Matrix((along, palm, along.cross(palm))).transposed()
