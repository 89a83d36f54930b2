# The words on the screen of Studio. The same keys stand in es.ftl.

window-title = Ademán Studio

## Toolbar

button-pause = Pause
button-resume = Resume
button-recenter = Recenter
button-zero = Zero
hint-pause = Release everything and suppress all events, or resume
hint-recenter = Move the boards below the index fingertip
hint-zero = Rest the hand first: its present angles count as its rest pose
hint-view = Change the 3D view
button-fingertip = Mouse as fingertip
hint-fingertip = Press keys and drag controls in the 3D view with the mouse; nothing is sent to other programs
hint-panel = Show or hide this panel
menu-view = View
view-eye = From the eye
view-above = From above
view-side = From the side
view-bones = Bones and joints
view-opaque = Opaque hand
view-trails = Trails of the fingertips
view-reach = Reach
menu-open = Open layout
layouts-hint = Everything is released, then the session goes on with another layout
layouts-recent = Opened before
layouts-file = File of a layout
layouts-button = Open
layouts-shipped = With the program
layouts-missing = { $file } is no longer there; it was removed from the list
menu-devices = Devices
devices-hint = Source, glove, person and outputs
devices-words = After a choice everything is released, then the session goes on with it.
devices-unsaved = The glove has changes that are not saved, which would be lost. Save or undo them in the panel “Sensors”, then choose again.
devices-use = Use
devices-source = Source
devices-search = Search again
devices-silent = { $port }: nothing arrives. Switch the glove on, then search again.
devices-recordings = Recordings, the newest first:
devices-recording = Recording
devices-recording-hint = File, such as session.mcap
devices-uri = Other source
devices-uri-hint = As after --source: udp:127.0.0.1:9000
devices-keys = A source on the network only points until you allow keys here.
devices-glove = Glove
devices-glove-own = As the source needs it
devices-glove-file = or a file
devices-person = Person
devices-person-none = None
devices-person-file = or a file
devices-arm = Arm
devices-arm-person = As the person
devices-arm-measured = As measured in the setup
devices-arm-file = or a file
devices-output = Outputs
devices-output-hint = or several, or with an argument, as after --output
devices-output-paused = An output that was chosen here starts paused: Resume lets it type.
devices-profile = Profile
devices-setup = Setup
devices-setup-hint = File, in place of everything above
devices-waiting = The next session has not started
devices-waiting-words = Its source or its outputs are not open. The desktop may ask whether Ademán may type. Until then, nothing is pressed. With P it starts paused.
menu-hand = Simulated hand
hand-speed = Speed
hand-noise = Noise of its sensors
hand-noise-hint = Standard deviation: counts of a glove, millimetres of a camera
hand-person = Person
hand-person-own = As at the start
hand-person-file = File of a person
hand-person-open = Open
menu-settings = Settings
menu-help = Help
theme-system = Colors of the system
theme-light = Light
theme-dark = Dark
theme-contrast = High contrast
scale-larger = Larger (Ctrl+Plus)
scale-smaller = Smaller (Ctrl+Minus)
scale-normal = Normal size (Ctrl+0)
sound-clicks = Click on each press
sound-volume = Volume of the clicks
panel-sensors = Sensors
panel-scope = Scope
panel-space = 3D view
panel-recording = Recording
panel-toolbar = Toolbar
panel-status = Status line
panel-calibration = Calibration
panel-editor-error = Layout editor
panel-editor-bar = Tools of the editor
panel-editor-problems = Problems
panel-editor-form = Properties
panel-editor-canvas = Layout
panel-word = Panel

## Help

help-tour = Tour
help-guide = The guide comes with the sources:
keys-title = Keys
keys-next-panel = Next panel
keys-previous-panel = Previous panel
keys-orbit = Orbit the 3D view (F6 focuses it)
keys-pan = Pan the 3D view
keys-zoom = Zoom the 3D view or the scope
keys-tab = Next or previous control
keys-operate = Operate the focused control
keys-escape = Close a menu or a window
keys-palette = Commands of the layout editor
keys-scale = Larger, smaller
keys-normal-scale = Normal size

## Tour

tour-step = Step { $step } of { $count }
tour-next = Next
tour-back = Back
tour-skip = Skip the tour
tour-done = Done
tour-view = The hand and its boards
tour-view-words = The 3D view shows the hand as Ademán understands it. A ring on the board shrinks as a fingertip nears it, and a pressed key sinks and lights up. Drag to orbit, scroll to zoom, or press 1, 2 or 3.
tour-pause = Pause at any time
tour-pause-words = The first button, or P, releases every key and sends nothing until you resume. To pause from any program, name panic keys in your setup file, such as both Ctrl keys: panic_keys: ["ControlLeft", "ControlRight"].
tour-sensors = Sensors
tour-sensors-words = The panel on the right shows each sensor and the angle that it measures. The signs ×, ▲ and ▼ warn of a broken wire, and ■ of a stuck sensor. If the angles do not follow your hand, calibrate the glove in the tab Calibration.
tour-layout = Your own layout
tour-layout-words = The tab Layout shows the layout from above: drag its keys and bind them. Save writes a copy of one that comes with the program. Open yours with ademan studio --layout FILE: each time it is saved, here or in a text editor, the hand types on it.
tour-output = Connect an output safely
tour-output-words = Nothing is typed into other programs until a setup file names an output, or you choose one under Devices. The line at the bottom always says which. Try the layout here first, check the pause and the panic keys, and run ademan doctor before you connect one.

## 3D view

typed-hint = The text so far, with Backspace applied
candidate-hint = Takes this word in place of the one that is typed
hint-fingertip-camera = press and drag controls · beside them or with Shift: orbit · right drag: pan · nothing is sent to other programs
hint-camera = drag: orbit · right drag: pan · scroll: zoom · 1 2 3: views

## Sensors

channel-joint = Joint
channel-count = Count
channel-angle = Angle
channel-none = This source has no channels: it measures angles or positions.
channel-no-reading = No reading has arrived yet.
stats-source = Source
stats-source-simulated = simulated hand
stats-source-mouse = mouse
stats-rate = Readings per second
stats-accepted = Accepted
stats-dropped = Dropped
stats-losses = Device lost
stats-stalls = Stalls

## Scope

scope-angles = Angles
scope-rows = Rows
scope-heights = Height of fingertips
scope-latency = Latency
scope-presses = Presses by finger
scope-events = Keys sent
scope-hold = Hold the plot
scope-latest = Last 30 s
scope-hint = scroll: zoom · drag: pan · double click: last 30 s
scope-plot = Plot of angles, fingertips and presses over time
scope-not-sent = Another program does not send joint angles and latencies

## Status line

state-starting = Starting
state-running = Running
state-paused = Paused
state-stalled = No readings
state-unusable = No usable readings: { $reason }
state-stopped = Ended
typing-nowhere = Nothing is typed into other programs
typing-suppressed = Paused: nothing is typed into other programs
typing-into = Types into other programs: { $output }

## Headset

headset-title = Headset
headset-connected = Headset { $name } at { $address }
headset-none = No headset connected
headset-hint = Link for the headset, and its keys
headset-open = Scan the code with the headset, or open this link in its browser. It is a password: a person who has it can move your pointer.
headset-certificate = The browser warns about the certificate, because this computer created it; accept the warning once.
headset-code = QR code of the link
headset-show = Show the link
headset-hide = Hide the link
headset-keys = Until you allow keys here, it only points.
headset-allow = Allow keys
headset-forbid = Forbid keys
headset-allow-hint = Releases everything; then all sources of the session press keys until it ends or another sender follows
headset-forbid-hint = Releases everything; then all sources of the session only point

## Notices of the session

notice-disarmed = Paused: hold the hand clear of all keys for a moment to arm
notice-armed = Armed: touches are sent to other programs
notice-armed-nowhere = Armed: nothing is typed into other programs
notice-stalled = No usable readings: everything is released
notice-output-stalled = This program or its output did not respond in time: everything is released. This machine is too busy, or the program was stopped
notice-paused = Paused: everything is released
notice-paused-by-layout = Paused by a key or gesture of the layout, which also resumes: everything is released
notice-paused-by-rate = Paused: more presses than a person makes (max_presses_per_second in the setup); everything is released
notice-left-lost = The left hand is not tracked: what it held is released, and it touches nothing
notice-right-lost = The right hand is not tracked: what it held is released, and it touches nothing
notice-left-stuck = The tracker of the left hand has repeated exactly the same positions for 5 s: what the hand held is released, and it touches nothing until the positions change. If they stay the same while you move the hand, check the camera and restart the tracker
notice-right-stuck = The tracker of the right hand has repeated exactly the same positions for 5 s: what the hand held is released, and it touches nothing until the positions change. If they stay the same while you move the hand, check the camera and restart the tracker
notice-left-too-fast = The left hand has pressed faster than the rate limit: what it held is released, and it touches nothing until the session is resumed
notice-right-too-fast = The right hand has pressed faster than the rate limit: what it held is released, and it touches nothing until the session is resumed
notice-left-found = The left hand is tracked again
notice-right-found = The right hand is tracked again
notice-sensors-work = The sensors of all fingers work again
notice-watchdog-lost = The watchdog exited or hangs: everything is released

message-ended = The session has ended. Everything is released.

## Recording

recording-play = Play
recording-pause = Pause
recording-first = First reading
recording-back = Previous reading
recording-on = Next reading
recording-last = Last reading
recording-position = Position
recording-speed = Speed
recording-hint = Left, Right: one reading; with Shift: 1 s; Home, End; Space: play or pause
recording-step = reading { $index } of { $count }
recording-loading = Reading the recording: { $count } readings so far
recording-cut = The recording is not complete: { $reason }. Everything before is shown.
recording-part = Part
recording-from = From here
recording-to = To here
recording-file = File
recording-export = Export the part
recording-exporting = Writing…
recording-exported = { $count ->
        [one] 1 reading is in { $file }
       *[other] { $count } readings are in { $file }
    }
recording-replace = { $file } exists.
recording-replace-yes = Replace it
recording-replace-no = Keep it
recording-compare = Compare with the layout
recording-compare-go = Compare
recording-compare-close = Close
recording-comparing = Comparing…
recording-same = same: { $count }
recording-only-a = only A: { $count }
recording-only-b = only B: { $count }
recording-rows = Presses of both layouts over the time of the recording; a click goes to the time

## Names of joints

finger-thumb = Thumb
finger-index = Index
finger-middle = Middle
finger-ring = Ring
finger-little = Little
finger-of-left = left
finger-of-right = right
joint-shoulder-z = Shoulder, first axis
joint-shoulder-y = Shoulder, second axis
joint-shoulder-x = Upper arm, turn
joint-elbow = Elbow
joint-forearm = Forearm, turn
joint-second-bone = Forearm, second bone
joint-wrist-sideways = Wrist, sideways
joint-wrist-bend = Wrist, bend
joint-base-sideways = base, sideways
joint-base = base
joint-knuckle = knuckle
joint-sideways = sideways
joint-middle = middle joint
joint-end = end joint

## Sensors: channels

sensor-channels = Channels
sensor-bar = Signal
sensor-bar-hint = Triangles: limits of the joint. Shaded: calibrated range.
sensor-channel-hint = Channel { $channel } { $label }: select it to change its values
sensor-count-name = { $count ->
        [one] Channel { $channel }: 1 count
       *[other] Channel { $channel }: { $count } counts
    }
sensor-no-count = Channel { $channel }: no value
sensor-missing = No value
sensor-low-end = At its lower end: check the wire
sensor-high-end = At its upper end: check the wire
sensor-stuck = Stuck while the finger bends

## Sensors: values of a channel

value-gain = Full range
value-gain-hint = Change of the angle over all counts of the sensor (full_scale_rad in the glove file)
value-offset = Count at 0°
value-offset-hint = Count of the straight joint (minus offset_counts in the glove file)
value-inverted = Inverted
value-inverted-hint = The angle falls while the count rises, as with exchanged wires
value-range = Range
value-range-hint = Smallest and largest count of this hand; --learn-ranges may widen it (range_counts in the glove file)
value-plot = Plot below

## Sensors: glove file

glove-save = Save
glove-undo = Undo
glove-redo = Redo
glove-undo-hint = Undo the last change of the glove
glove-redo-hint = Repeat the undone change
glove-close-question = The calibration of the glove is not saved.
glove-unsaved = ● not saved
glove-replace = { $file } exists. Replace it? The present file is kept as { $backup }.
button-replace = Replace
button-cancel = Cancel

## Sensors: source

stats-state = State
stats-dropped-presses = Presses the output dropped
stats-suppressed = Events suppressed
stats-rejected = Rejected
stats-latency = Latency p50 / p99 / max
front-turns = { $turns } turns

## Sensors: filter

filter-title = Filter
filter-one-euro = 1-Euro
filter-average = Recursive average
filter-off = None
filter-cutoff = Cutoff at rest
filter-cutoff-hint = Lower: less jitter, more lag at rest (min_cutoff_hz)
filter-beta = Rise with speed
filter-beta-hint = Higher: less lag in motion (beta, in Hz per rad/s)
filter-joint = Joint
filter-raw = before
filter-filtered = after the filter
filter-lag = lag { $ms } ms
filter-no-lag = move the joint to measure the lag
filter-plot = Angle before and after the filter, last 5 s
filter-copy = Copy
filter-copy-hint = Copy the setting for the setup file

## Guided calibration

workspace-hand = Hand
workspace-calibration = Calibration
calibration-title = Guided calibration of { $glove }
calibration-intro = Take each pose as in the picture and hold it for a second. The session is paused until the end, and nothing is typed. No file changes before you save.
calibration-start = Start
calibration-fingers = Also each finger alone
calibration-fingers-hint = Five more poses, which find exchanged sensors of two fingers
calibration-demo = Watch a simulated person
calibration-demo-hint = A simulated person in a glove that is not calibrated takes the poses
calibration-simulated = The hand of this session is simulated and takes no poses. Choose a glove under Devices, or watch a simulated person.
calibration-is-demo = Demonstration with a simulated person
calibration-none = This source needs no glove file, so there is nothing to calibrate.
calibration-pose = Pose { $number } of { $count }
calibration-prepare = Get ready: { $seconds }
calibration-take = Take the pose
calibration-moving = Hold still
calibration-holding = Hold still …
calibration-done = Done
calibration-repeat = Repeat (R)
calibration-skip = Skip (S)
calibration-quit = Quit (Q)
calibration-repeat-hint = Take this pose again, or the one before during the countdown
calibration-above = from above
calibration-below = from below
calibration-side = from the side
calibration-score = Score { $score } of 100
calibration-no-problem = No sensor has a problem.
calibration-moved = Channel { $channel } follows another finger than in the glove file: { $followed }, not { $stated }
calibration-matched = The result has these sensors at the fingers that they follow.
calibration-unmatched = A finger has more sensors than in the glove file, so the channels stay: check wires and plugs.
calibration-uncompared = The sensors of the fingers were not compared: a pose that bends one finger was skipped.
calibration-before = Before
calibration-after = After
calibration-use = Use and save
calibration-use-hint = Use the result now, and save it to { $file }
calibration-try = Use without saving
calibration-failed = No calibration
glove-saved = Saved to { $file }. Undo in the panel “Sensors” returns to the values of before; save again to write them.
pose-rest = Lay the hand on the table and relax it
pose-flat = Press palm and fingers flat on the table, fingers and thumb together
pose-fist = Make a tight fist, with the thumb bent across the fingers
pose-spread = Lay the hand flat on the table, and spread fingers and thumb as far as they go
pose-pinch = Touch the tip of the thumb with the index finger, the other fingers straight
pose-elbow-straight = Stretch the arm straight, fingers straight
pose-elbow-bent = Bend the elbow to a right angle, fingers straight
pose-wrist-up = Bend the wrist up as far as it goes, fingers straight
pose-wrist-down = Bend the wrist down as far as it goes, fingers straight
pose-wrist-in = Hand flat on the table: turn it towards the thumb as far as it goes
pose-wrist-out = Hand flat on the table: turn it towards the little finger as far as it goes
pose-palm-up = Forearm on the table: turn the palm up as far as it goes, fingers straight
pose-palm-down = Lay the hand flat on the table again, palm down
pose-thumb-bent = Bend only the thumb, the fingers straight
pose-index-bent = Bend only the index finger, the others straight
pose-middle-bent = Bend only the middle finger, the others straight
pose-ring-bent = Bend only the ring finger, the others straight
pose-little-bent = Bend only the little finger, the others straight

## Layout editor

editor-canvas = Board
editor-hint = click, Shift-click or drag: select · drag a key: move (Alt: freely) · right drag: pan · scroll: zoom · arrows: grid step (Shift: 0.1 mm)
editor-hint-empty = “Add” in the bar puts a key or another control here
editor-save = Save
editor-save-hint = Write the file (Ctrl-S)
editor-save-as = Save as…
editor-save-as-hint = Write a copy under another name, and go on with it
editor-save-path = File
editor-save-needs-name = Write the name of a file, not of a folder
editor-cancel = Cancel
editor-saved = Saved
editor-undo = Undo
editor-undo-hint = Undo the last edit (Ctrl-Z)
editor-redo = Redo
editor-redo-hint = Make the last undone edit again (Ctrl-Y)
editor-add = Add
editor-new-sequence = Sequence
editor-sequences = Sequences
editor-add-step = Add step
editor-step-kind = Kind of step
editor-step-earlier = Move the step up
editor-name = Name
editor-duplicate = Duplicate
editor-duplicate-hint = Copy what is selected (Ctrl-D)
editor-delete = Delete
editor-delete-hint = Delete what is selected (Delete)
editor-new-board = Board
editor-new-layer = Layer
editor-new-trigger = Trigger
editor-new-pointer = Pointer
editor-new-space = Targets in space
editor-add-chord = Chord of the selected keys
editor-add-chord-hint = Select at least two keys on the board
editor-add-target = Add a target
editor-align-left = Align left edges
editor-align-center = Align centers from the wearer away
editor-align-right = Align right edges
editor-align-far = Align far edges
editor-align-middle = Align centers along the row
editor-align-near = Align near edges
editor-distribute-x = Equal gaps from left to right
editor-distribute-y = Equal gaps from near to far
editor-mirror-x = Mirror left and right
editor-mirror-y = Mirror near and far
editor-snap = Snap
editor-snap-hint = Edges and centers of other keys, and the grid, attract what is dragged
editor-try = Try at once
editor-try-hint = The running session uses the edited text before it is saved. Each valid edit releases everything first; a finger inside a key must leave it. Off: the session returns to the saved text.
editor-grid = Grid
editor-rulers = Rulers
editor-rulers-hint = Millimetres along the upper and the left edge, with the pointer and what is selected
editor-fit = Show all
editor-fit-hint = Show the whole board
editor-board = Board { $number }
editor-no-problems = No problems
editor-unbalanced = Brackets of the text are not balanced; correct the first problem in the text, or undo
editor-layout = Layout
editor-pointer = Pointer
editor-boards = Boards
editor-layers = Layers
editor-chords = Chords
editor-triggers = Triggers
editor-spaces = Targets in space
editor-nothing-selected = Nothing is selected. Click a key, or drag around several.
editor-several-selected = { $count } parts selected
editor-remove-field = Use the default
editor-optional = Options that have their defaults
editor-binding = Binding
editor-search = Search for a key
editor-press-key = Press the key
editor-press-key-hint = Take the next key that is pressed on the keyboard
editor-pressing = Press a key now; click to cancel
editor-unbind = Remove
editor-changed-outside = Another program has changed the file, in places that are changed here, too.
editor-merged = Another program has changed the file; its changes are in this text, too.
editor-keep-mine = Keep mine
editor-take-theirs = Take the file
editor-close-question = The layout has unsaved changes.
editor-close-save = Save and close
editor-close-discard = Close without saving
editor-close-cancel = Keep editing
editor-cannot-open = The layout cannot be opened in the editor
editor-recovered = Unsaved work of another session was found.
editor-open-elsewhere = Another Studio has this layout open: each can save, the other one merges, or asks
editor-restore = Restore
editor-discard = Discard
workspace-layout = Layout
editor-slot-base = Pressed
editor-slot-hold = Held
editor-slot-layer = Layer
editor-command = Command
editor-multitap = One of
editor-clutch = Hold the pointer still
editor-precision = Slow the pointer down
editor-no-action = No action
editor-width = Width
editor-depth = Depth
editor-diameter = Diameter
editor-angle = Angle
editor-reloaded = Another program has changed the file; it was read again.
editor-replace = Replace the file
editor-row = Row
editor-option = Option
editor-target = Target
editor-chord = Chord

## Overlay

overlay-title = Ademán overlay
overlay-opacity = Opacity
overlay-place = Move this window to the place of the overlay, then close it.
overlay-opaque = the overlay is small and opaque, as no compositor runs on this desktop; start one, such as picom, for a transparent one
overlay-window-only = the overlay is an ordinary window, as this desktop lets no window stay above the others: choose that in its window menu, or install Xwayland

# Layout editor: problems, clipboard, repetition, palette
editor-cannot-run = No session can use this layout before its errors are corrected.
editor-save-anyway = Save anyway
editor-saved-with-errors = Saved with errors: no session can use it yet
editor-copied = Copied as text of a layout
editor-not-copied = Controls, boards, triggers and targets go to the clipboard, nothing else of a layout
editor-copy = Copy
editor-cut = Cut
editor-paste = Paste
editor-select-all = Select all
editor-zoom-selection = Show what is selected
editor-snap-to-grid = Move what is selected to the grid
editor-nudge-left = Move to the left
editor-nudge-right = Move to the right
editor-nudge-up = Move up in the picture
editor-nudge-down = Move down in the picture
editor-repeat = Repeat
editor-repeat-now = Repeat along the grid
editor-columns = Columns
editor-rows = Rows
editor-pitch-x = To the right
editor-pitch-y = Away
editor-repeat-arc = Repeat along an arc
editor-repeat-arc-hint = The copies turn with the arc. Its center is towards the wearer; with a negative radius it is on the far side.
editor-arc-count = Number
editor-arc-step = Angle between
editor-arc-radius = Radius
editor-palette = Commands
editor-palette-hint = Part of a name
editor-palette-none = No command matches
editor-mixed = mixed
editor-open = Open…
editor-open-hint = Open a file, an empty layout, or a copy of a layout that comes with the program (Ctrl-O)
editor-open-title = Open a layout
editor-open-empty = Empty layout
editor-open-name = File, or part of the name of a layout that comes with the program
editor-open-unsaved = This layout has unsaved changes. They are kept, and offered when it is opened again.
editor-open-unkept = The layout has unsaved changes, which cannot be kept and would be lost. Save or undo them in the tab “Layout”, then choose again.
editor-export = Write a picture (SVG)
editor-export-png = Write a picture of pixels (PNG)
editor-export-pdf = Write a page to print (PDF)
editor-copy-link = Copy link (share the layout)
editor-link-copied = The link is in the clipboard; it opens the layout in the page of `ademan serve`
editor-export-svg-only = this window makes neither PNG nor PDF; write an SVG picture
editor-exported = The picture is written beside the layout
editor-exported-here = The picture is written to the folder in which Studio was started, as the layout has no file
editor-export-exists = the picture exists and is not overwritten; move it away

# Layout editor: all boards
editor-plan = All boards
editor-plan-tab-hint = All boards and targets in space where they are, with the hand at rest
editor-plan-canvas = Plan of all boards
editor-plan-hint = drag: move (Alt: freely) · round handles: turn, tilt, bend · double click: open a board · right drag: pan · scroll: zoom
editor-plan-free-hint = drag: move in the plane of the picture (Alt: freely) · right drag, Ctrl-arrows: turn the view · middle drag: pan · scroll: zoom
editor-view-front = From the front
editor-view-free = Free view

## First start

first-title = Ademán Studio: first start
first-source = What was found
first-hand = Which hand
first-layout = Layout
first-start = Ready
first-no-port = No serial port is present. Connect the glove, then start Studio again.
first-listening = { $port }: listening for a few seconds …
first-recognized = { $port } has a device:
first-unknown = { $bytes ->
        [one] { $port }: 1 byte of no known device. Check its bit rate.
       *[other] { $port }: { $bytes } bytes of no known device. Check its bit rate.
    }
first-silent = { $port }: nothing arrives. Switch the glove on, then start Studio again.
first-closed = { $port }: cannot listen: { $reason }
first-camera = Camera { $camera }: it follows your hand with the command { $command } in a terminal.
first-simulated = Simulated hand
first-simulated-words = It uses each control of the layout by itself, so that you see what happens. No file is written.
first-hand-words = The hand that is measured:
first-right = Right hand
first-left = Left hand
first-layout-words = Proposed for this sensor and hand: { $layout }
first-mirrored = Mirror image of { $layout }, in a file of its own
first-summary-source = Source
first-summary-hand = Hand
first-summary-layout = Layout
first-calibrate = Calibrate the glove first: a few poses, about a minute
first-keep = Keep as the setup of every run without another one
first-begin = Start
first-skip = Skip
first-skip-all = Skip all: simulated hand

## The lab
workspace-lab = Lab
panel-watched = Person of the lab
lab-controls = Conditions
lab-results = Figures
lab-board = Board with the controls that were missed
lab-intro = Simulated people use the layout of the editor, saved or not, through the whole program. Nothing is typed into other programs. docs/lab.md says what the people are made of.
lab-people = People
lab-phrases = Phrases of each
lab-corpus = Texts
lab-tier = Errors
lab-own-errors = their own
lab-source = Sensor
lab-decoder = Text decoder
lab-seed = Seed
lab-compare = Compare with
lab-compare-nothing = nothing
lab-compare-saved = the layout as it was saved
lab-compare-file = another layout:
lab-compare-name = Name or path of the other layout
lab-saved = saved
lab-run = Run
lab-run-hint = Scores the layout on threads of its own
lab-run-invalid = The layout has errors; the tab Layout lists them
lab-run-unnamed = Name the layout to compare with
lab-cancel = Cancel
lab-progress = { $all ->
        [one] { $done } of 1 person
       *[other] { $done } of { $all } people
    }
lab-no-results = No run yet
lab-stale = The layout was changed since this run
lab-conditions = { $people ->
        [one] 1 person
       *[other] { $people } people
    }, { $phrases ->
        [one] 1 phrase
       *[other] { $phrases } phrases
    } each of { $corpus }; errors: { $tier }; sensor { $source }; decoder { $decoder }; seed { $seed }. Simulated; ranges are intervals of 95 % from resampled populations.
lab-wpm = Words of correct text/min
lab-cer = Wrong characters, %
lab-insertions = … too many, %
lab-deletions = … missing, %
lab-substitutions = … other ones, %
lab-wer = Wrong words, %
lab-oov = Words not in the lexicon, %
lab-kspc = Keystrokes per character
lab-hits = Strokes that hit, %
lab-travel = Joint travel, °/character
lab-worst = Worst tenth
lab-worst-values = { $cer } % wrong; { $wpm } words/min
lab-untypable = The layout cannot type these characters, which are left out: { $characters }
lab-unreached = Out of reach of some people: { $names }
lab-minus = { $second } minus { $first }
lab-points-cer = Wrong characters, points
lab-points-uncomfortable = Outside comfortable range, points
lab-points-tasks = Tasks done, points
lab-seconds-task = Seconds per task
lab-throughput = Throughput, bit/s
lab-points-misses = Clicks beside the target, points
lab-worst-people = Worst people
lab-watch-hint = Click on a person to watch the phrase that went worst
lab-watch-tasks = Tasks cannot be watched
lab-person = Person { $number }, { $hand } mm, { $fingers }: { $failure } %
lab-heat-hint = The stronger the color, the more strokes missed the control; point at one for its figures
lab-watch-note = a simulated person; nothing is typed into other programs
lab-watch-back = Back to the lab
lab-watch-next = Next miss
lab-watch-failure = next: { $pressed } for { $meant }
lab-watch-unmeant = no key
lab-watch-nothing = nothing
lab-watch-presented = To be typed
lab-watch-typed = Typed

## Session of another program

attached-name = Another session: { $session }
attached-process = Process { $process }
attached-hint = The window shows the session of another program and sends it commands. Closing the window does not end it.
attached-next-profile = Next profile
attached-text = Text decoder
attached-literal = Changes nothing
attached-suggest = Offers candidates
attached-auto = Corrects words
attached-sensors = Channels, filter and calibration are in the program of this session. For a session of this window: ademan studio --attach off
