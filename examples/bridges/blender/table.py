class TableError(Exception):
    """A table that cannot be used, with the reason."""


class Target:
    """An object, or a bone of one: `Object` or `Armature/bone`."""

    def __init__(self, name):
        name, _, self.bone_name = name.partition("/")
        self.object = bpy.data.objects.get(name)
        if self.object is None:
            raise TableError(f"there is no object `{name}`")

    @property
    def bone(self):
        """The bone, which is another one after the skeleton was edited."""
        bone = self.object.pose and self.object.pose.bones.get(self.bone_name)
        if bone is None:
            raise TableError(f"object `{self.object.name}` has no bone `{self.bone_name}`")
        return bone

    @property
    def owner(self):
        return self.bone if self.bone_name else self.object


class Attachment:
    """A channel that sets an attribute: value = channel * scale + offset."""

    def __init__(self, row):
        self.device, self.channel = row["device"], row["channel"]
        self.scale, self.offset = float(row.get("scale", 1)), float(row.get("offset", 0))
        if not (math.isfinite(self.scale) and math.isfinite(self.offset)):
            raise TableError("scale and offset are finite numbers")
        self.target, path = Target(row["target"]), row["attribute"]
        owner = self.target.owner
        self.head, self.name, self.index, self.kind = "", path, -1, float
        if path.startswith('["') and path.endswith('"]'):
            if path[2:-2] not in owner:
                owner[path[2:-2]] = 0.0
            return
        head, _, last = path.rpartition(".")
        if last in ("w", "x", "y", "z") and head:
            self.head, _, vector = head.rpartition(".")
            self.name = vector
            quaternion = vector in ("rotation_quaternion", "rotation_axis_angle")
            self.index = ("wxyz" if quaternion else "xyz").index(last)
            self.kind = type(getattr(self.struct, vector)[self.index])
        else:
            self.head, self.name = head, last
            self.kind = type(getattr(self.struct, last))
            if self.kind not in (bool, int, float):
                raise TableError(f"`{path}` is not a number; add the axis, as in `location.x`")
        if self.name == "rotation_euler" and owner.rotation_mode in ("QUATERNION", "AXIS_ANGLE"):
            owner.rotation_mode = "XYZ"

    @property
    def struct(self):
        """The object or property group with the attribute."""
        owner = self.target.owner
        return owner.path_resolve(self.head) if self.head else owner

    def apply(self, channels):
        if self.channel not in channels:
            return
        value = channels[self.channel] * self.scale + self.offset
        if self.kind is not float:
            value = value >= 0.5 if self.kind is bool else round(value)
        if self.name.startswith('["'):
            self.struct[self.name[2:-2]] = value
        elif self.index >= 0:
            getattr(self.struct, self.name)[self.index] = value
        else:
            setattr(self.struct, self.name, value)

    def key(self, frame):
        self.struct.keyframe_insert(self.name, index=self.index, frame=frame)


class BoneRow:
    """A bone of a skeleton that takes the direction and the turn of a bone of the arm or hand."""

    def __init__(self, row, turn):
        self.device, self.joint = row["device"], row["joint"]
        if self.joint not in BONE_ENDS and self.joint != "wrist":
            raise TableError(f"no bone begins at a joint `{self.joint}`")
        target = self.target = Target(row["target"])
        if not target.bone_name:
            raise TableError(f"`{row['target']}` is not a bone; name it as `Armature/bone`")
        self.bone.rotation_mode = "QUATERNION"
        self.world_from_armature = target.object.matrix_world.to_3x3().normalized()
        self.rest = self.bone.bone.matrix_local.to_3x3()
        palm = Vector(row.get("palm", (0, 0, -1)))
        if palm.length < 1e-6:
            raise TableError("`palm` is not a direction")
        # At rest the palm faces down, as in the T pose.
        rest = axes((self.world_from_armature @ self.rest).col[1].normalized(), palm)
        self.turn = turn
        self.bone_from_axes = rest.transposed() @ self.world_from_armature @ self.rest

    @property
    def bone(self):
        return self.target.bone

    def wanted(self, bones):
        """Returns the rotation of the bone in its skeleton; None if the hand does not show it."""
        if self.joint not in bones:
            return None
        return self.world_from_armature.transposed() @ self.turn @ bones[self.joint] @ self.bone_from_axes

    def apply(self, wanted):
        rotation = (parent_from_rest(self.bone, wanted) @ self.rest_from_parent()).transposed() @ wanted[self.bone.name]
        rotation = rotation.to_quaternion()
        if rotation.dot(self.bone.rotation_quaternion) < 0:
            rotation.negate()
        self.bone.rotation_quaternion = rotation

    def rest_from_parent(self):
        parent = self.bone.parent
        return parent.bone.matrix_local.to_3x3().transposed() @ self.rest if parent else self.rest

    def key(self, frame):
        self.bone.keyframe_insert("rotation_quaternion", frame=frame)


def parent_from_rest(bone, wanted):
    """Returns the rotation of the parent of a bone in the skeleton: the wanted one, or the rotation of its pose."""
    parent = bone.parent
    if parent is None:
        return Matrix.Identity(3)
    if parent.name in wanted:
        return wanted[parent.name]
    rest = parent.bone.matrix_local.to_3x3()
    if parent.parent:
        rest = parent.parent.bone.matrix_local.to_3x3().transposed() @ rest
    return parent_from_rest(parent, wanted) @ rest @ parent.matrix_basis.to_3x3()


class Table:
    """A table of mappings whose targets are in this file of Blender. `faults` are the rows that cannot be used."""

    def __init__(self, text):
        try:
            table = json.loads(text)
        except ValueError as error:
            raise TableError(f"it is not JSON: {error}")
        if not isinstance(table, dict) or table.get("format") != "ademan-mapping":
            raise TableError('it has no `"format": "ademan-mapping"`')
        if table.get("version") != 1:
            raise TableError(f"its version is {table.get('version')}, and this add-on reads version 1")
        turn_deg = table.get("turn_deg", 180)
        if not isinstance(turn_deg, (int, float)) or not math.isfinite(turn_deg):
            raise TableError("`turn_deg` is not an angle in degrees")
        self.faults = []
        turn = Matrix.Rotation(math.radians(turn_deg), 3, "Z")
        self.attach = self.rows(table, "attach", Attachment)
        self.bones = self.rows(table, "bones", lambda row: BoneRow(row, turn))

    def rows(self, table, name, make):
        made, rows = [], table.get(name, [])
        if not isinstance(rows, list):
            raise TableError(f"`{name}` is not a list")
        for number, row in enumerate(rows, 1):
            try:
                if row["device"] not in ("left", "right"):
                    raise TableError(f"the device is `{row['device']}`; it is `left` or `right`")
                made.append(make(row))
            except KeyError as error:
                self.faults.append(f"{name} {number}: there is no {error}")
            except (AttributeError, IndexError, TableError, TypeError, ValueError) as error:
                self.faults.append(f"{name} {number}: {error}")
        return made

    def apply(self, hand):
        """Moves everything that a hand moves."""
        channels, bones = hand.channels(), hand.bones()
        for row in self.attach:
            if row.device == hand.side:
                row.apply(channels)
        rows = [(row, row.wanted(bones)) for row in self.bones if row.device == hand.side]
        skeletons = {}
        for row, wanted in rows:
            if wanted is not None:
                skeletons.setdefault(row.bone.id_data.name, {})[row.bone.name] = wanted
        for row, wanted in rows:
            if wanted is not None:
                row.apply(skeletons[row.bone.id_data.name])

    def key(self, side, frame):
        """Inserts a key frame for everything that a hand moves."""
        for row in self.attach + self.bones:
            if row.device == side:
                row.key(frame)


# A time that is so much earlier comes from another start of the program.
RESTART_US = 500_000


class Take:
    """Recorded hands by side, in the order of time."""

    def __init__(self):
        self.hands = {"left": [], "right": []}
        # The latest time, when it came, and what is added to the times of a program that was started again.
        self.latest_us, self.came, self.offset_us = 0, time.monotonic(), 0

    def add(self, hand):
        hands, now = self.hands[hand.side], time.monotonic()
        if hand.time_us + self.offset_us < self.latest_us - RESTART_US:
            self.offset_us = self.latest_us + round((now - self.came) * 1e6) - hand.time_us
        hand.time_us += self.offset_us
        self.latest_us, self.came = max(self.latest_us, hand.time_us), now
        if not hands or hand.time_us > hands[-1].time_us:
            hands.append(hand)

    def seconds(self):
        ends = [(hands[0].time_us, hands[-1].time_us) for hands in self.hands.values() if hands]
        return (max(end for _, end in ends) - min(start for start, _ in ends)) * 1e-6 if ends else 0.0

    def bake(self, table, scene, rate_hz):
        """Inserts key frames from the current frame on, and yields after each of them."""
        fps = scene.render.fps / scene.render.fps_base
        rate_hz, first = rate_hz or fps, scene.frame_current
        start = min(hands[0].time_us for hands in self.hands.values() if hands)
        places = {side: 0 for side in self.hands}
        for key in range(int(self.seconds() * rate_hz + 1e-6) + 1):
            time_us = start + key * 1e6 / rate_hz
            for side, hands in self.hands.items():
                if not hands or not hands[0].time_us - 1 <= time_us <= hands[-1].time_us + 1:
                    continue
                while places[side] + 2 < len(hands) and hands[places[side] + 1].time_us < time_us:
                    places[side] += 1
                hand, later = hands[places[side]], hands[min(places[side] + 1, len(hands) - 1)]
                gap = later.time_us - hand.time_us
                fraction = min(max((time_us - hand.time_us) / gap, 0.0), 1.0) if gap else 0.0
                table.apply(hand.between(later, fraction))
                table.key(side, first + key * fps / rate_hz)
            yield key
