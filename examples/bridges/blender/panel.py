class Link:
    """What the panel, the timer and the operators share."""

    def __init__(self):
        self.receiver = None
        self.table = None
        self.path = ""
        self.message = ""
        self.take = Take()
        self.recording = False
        self.baking = None
        # What the panel showed last.
        self.shown = None

    def load(self, path):
        """Loads the table of a file, or the starting table without a path."""
        self.path = path
        try:
            text = STARTING_TABLE
            if path:
                with open(bpy.path.abspath(path), encoding="utf-8-sig") as file:
                    text = file.read()
            self.table = Table(text)
            self.message = ""
        except (OSError, TableError, ValueError) as error:
            self.table = None
            self.message = f"{path or 'the starting table'}: {error}"
            print("Ademán:", self.message, flush=True)
            return
        for fault in self.table.faults:
            print("Ademán: a row is left out:", fault, flush=True)

    def find_targets(self):
        """Loads the table again, because objects or bones have changed. It is dropped if none of its rows is left."""
        was_baking = self.baking is not None
        self.baking = None
        self.load(self.path)
        if was_baking and not self.message:
            self.message = "an undo or an edit has interrupted the baking: bake again"
        if self.table and not (self.table.attach or self.table.bones):
            self.table = None
            self.message = "an object of the table has been removed: load the table again"

    def connect(self, host, port):
        self.disconnect()
        self.receiver = Receiver(host, port)
        self.receiver.start()

    def disconnect(self):
        if self.receiver:
            self.receiver.stopped.set()
        self.receiver = None

    def update(self):
        """Applies the latest lines, or bakes for a short time. Returns whether anything moves."""
        if self.baking:
            end = time.monotonic() + BAKE_S
            while time.monotonic() < end:
                if next(self.baking, None) is None:
                    self.baking = None
                    self.message = "baked"
                    break
            return True
        latest = {}
        while self.receiver and self.receiver.lines:
            hand = self.receiver.lines.popleft()
            latest[hand.side] = hand
            if self.recording:
                self.take.add(hand)
        if self.table:
            for hand in latest.values():
                self.table.apply(hand)
        return bool(latest)


LINK = Link()


def tick():
    """Runs in the timer of Blender, between the drawing of two pictures."""
    moves = False
    try:
        moves = LINK.update()
    except (ReferenceError, TableError):
        # An undo replaces all objects, and an edit the bones.
        LINK.find_targets()
    except Exception as error:
        # A timer that fails is never called again.
        LINK.table, LINK.baking = None, None
        LINK.message = f"the table cannot be applied: {error}; correct it and load it again"
        print("Ademán:", LINK.message, flush=True)
    shown = (LINK.receiver and LINK.receiver.state, LINK.message)
    if not moves and shown == LINK.shown:
        return TICK_S
    LINK.shown = shown
    manager = bpy.context.window_manager
    for window in manager.windows if manager else []:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
    return TICK_S


class Settings(bpy.types.PropertyGroup):
    host: bpy.props.StringProperty(name="Host", default="127.0.0.1")
    port: bpy.props.IntProperty(name="Port", default=10003, min=1, max=65535)
    table: bpy.props.StringProperty(name="Table", subtype="FILE_PATH", description="JSON file; empty for the starting table")
    rate_hz: bpy.props.FloatProperty(name="Keys per second", default=0.0, min=0.0, max=1000.0, description="0: one for each frame")


class ADEMAN_OT_connect(bpy.types.Operator):
    """Connect to a hand that is shared with `--share pose`, or disconnect"""

    bl_idname, bl_label = "ademan.connect", "Connect"

    def execute(self, context):
        settings = context.scene.ademan
        if LINK.receiver:
            LINK.disconnect()
        else:
            LINK.load(settings.table)
            LINK.connect(settings.host, settings.port)
        return {"FINISHED"}


class ADEMAN_OT_load(bpy.types.Operator):
    """Load the table of mappings again"""

    bl_idname, bl_label = "ademan.load", "Load the table"

    def execute(self, context):
        LINK.load(context.scene.ademan.table)
        return {"FINISHED"}


class ADEMAN_OT_skeleton(bpy.types.Operator):
    """Add a skeleton of both arms that fits the starting table"""

    bl_idname, bl_label, bl_options = "ademan.skeleton", "Add a skeleton", {"UNDO"}

    def execute(self, context):
        if "Ademan" in bpy.data.objects:
            self.report({"ERROR"}, "there is an object `Ademan` already")
            return {"CANCELLED"}
        armature = bpy.data.objects.new("Ademan", bpy.data.armatures.new("Ademan"))
        context.collection.objects.link(armature)
        context.view_layer.objects.active = armature
        bpy.ops.object.mode_set(mode="EDIT")
        for side, sign in (("R", -1), ("L", 1)):
            add_arm(armature.data.edit_bones, side, sign)
        bpy.ops.object.mode_set(mode="OBJECT")
        LINK.load(context.scene.ademan.table)
        return {"FINISHED"}


def add_arm(bones, side, sign):
    """Adds the bones of an arm in the T pose: along X, palm down, thumb to the front."""

    def chain(names, start, along, lengths, parent=None):
        for name, length in zip(names, lengths):
            bone = bones.new(f"{name}.{side}")
            bone.parent, bone.head = parent, start
            bone.tail = start = start + along.normalized() * length
            parent = bone
        return parent

    out = Vector((sign, 0, 0))
    shoulder = Vector((sign * 0.18, 0, 1.4))
    hand = chain(["upper_arm", "forearm", "hand"], shoulder, out, (0.30, 0.26, 0.09))
    for name, across, length in (("index", -0.025, 0.045), ("middle", 0, 0.05), ("ring", 0.02, 0.045), ("pinky", 0.04, 0.035)):
        names = [f"f_{name}.{part:02}" for part in (1, 2, 3)]
        chain(names, hand.tail + Vector((0, across, 0)), out, (length, 0.6 * length, 0.45 * length), hand)
    thumb = [f"thumb.{part:02}" for part in (1, 2, 3)]
    chain(thumb, hand.head + Vector((sign * 0.02, -0.02, 0)), out + Vector((0, -1, 0)), (0.045, 0.035, 0.03), hand)


class ADEMAN_OT_record(bpy.types.Operator):
    """Start a recording, or end it"""

    bl_idname, bl_label = "ademan.record", "Record"

    def execute(self, _context):
        if not LINK.recording:
            LINK.take = Take()
        LINK.recording = not LINK.recording
        return {"FINISHED"}


class ADEMAN_OT_bake(bpy.types.Operator):
    """Insert the recording as key frames from the current frame on"""

    bl_idname, bl_label = "ademan.bake", "Bake to key frames"

    def execute(self, context):
        if LINK.table is None or LINK.take.seconds() == 0.0:
            self.report({"ERROR"}, "there is nothing to bake: load a table and record first")
            return {"CANCELLED"}
        LINK.recording = False
        LINK.baking = LINK.take.bake(LINK.table, context.scene, context.scene.ademan.rate_hz)
        LINK.message = "baking"
        return {"FINISHED"}


class ADEMAN_PT_panel(bpy.types.Panel):
    bl_idname, bl_label = "ADEMAN_PT_panel", "Ademán"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Ademán"

    def draw(self, context):
        settings, layout = context.scene.ademan, self.layout
        for name in ("host", "port", "table"):
            layout.prop(settings, name)
        layout.operator("ademan.load")
        layout.operator("ademan.skeleton")
        layout.operator("ademan.connect", text="Disconnect" if LINK.receiver else "Connect")
        if LINK.receiver:
            layout.label(text=LINK.receiver.state)
            layout.label(text=f"{LINK.receiver.received} poses, {LINK.receiver.invalid} invalid lines")
        for text in [LINK.message, *(LINK.table.faults[:8] if LINK.table else [])]:
            if text:
                layout.label(text=text)
        layout.prop(settings, "rate_hz")
        layout.operator("ademan.record", text="End the recording" if LINK.recording else "Record")
        layout.label(text=f"{LINK.take.seconds():.1f} s recorded")
        layout.operator("ademan.bake")


CLASSES = (
    Settings,
    ADEMAN_OT_connect,
    ADEMAN_OT_load,
    ADEMAN_OT_skeleton,
    ADEMAN_OT_record,
    ADEMAN_OT_bake,
    ADEMAN_PT_panel,
)


def register():
    for item in CLASSES:
        bpy.utils.register_class(item)
    bpy.types.Scene.ademan = bpy.props.PointerProperty(type=Settings)
    bpy.app.timers.register(tick, persistent=True)


def unregister():
    LINK.disconnect()
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    del bpy.types.Scene.ademan
    for item in reversed(CLASSES):
        bpy.utils.unregister_class(item)


if __name__ == "__main__":
    register()
