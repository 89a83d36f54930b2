# The words on the screen of Studio. The same keys stand in es.ftl.

window-title = Ademán Studio

## Toolbar

button-pause = Pause
button-resume = Resume
button-recenter = Recenter
button-zero = Zero
hint-pause = Release everything and suppress all events, or resume
hint-recenter = Move the boards below the index fingertip
hint-zero = Rest the hand first: its present angles become those of its rest pose
hint-view = Change the 3D view
hint-panel = Show or hide this panel
menu-view = View
view-eye = From the eye
view-above = From above
view-side = From the side
view-bones = Bones and joints
view-trails = Trails of the fingertips
view-reach = Reach
menu-settings = Settings
menu-help = Help
theme-system = Colors of the system
theme-light = Light
theme-dark = Dark
theme-contrast = High contrast
scale-larger = Larger (Ctrl+Plus)
scale-smaller = Smaller (Ctrl+Minus)
scale-normal = Normal size (Ctrl+0)
panel-sensors = Sensors
panel-scope = Scope
panel-space = 3D view
panel-toolbar = Toolbar
panel-word = Panel

## Help

help-tour = Tour
help-guide = The guide comes with the sources:
keys-title = Keys
keys-next-panel = Next panel
keys-previous-panel = Previous panel
keys-tab = Next or previous control
keys-operate = Operate the focused control
keys-escape = Close a menu or a window
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
tour-sensors-words = The panel on the right shows each sensor and the angle that it measures. A mark ! warns of a broken wire or a stuck sensor. If the angles do not follow your hand, calibrate the glove: ademan calibrate.
tour-layout = Your own layout
tour-layout-words = Keyboards, panels and instruments are text files. Copy one with ademan layout new, edit it, and open it with ademan studio --layout FILE: each time you save it, the view follows.
tour-output = Connect an output safely
tour-output-words = Nothing is typed into other programs until a setup file names an output. The line at the bottom always says which. Try the layout here first, check the pause and the panic keys, and run ademan doctor before you connect one.

## 3D view

hint-camera = drag: orbit · right drag: pan · scroll: zoom · 1 2 3: views

## Sensors

channel-column = Channel
channel-joint = Joint
channel-count = Count
channel-angle = Angle
channel-at-end = At the end of its range
channel-unchanged = Unchanged for 10 s
channel-none = This source has no channels: it measures angles or positions.
channel-no-reading = No reading has arrived yet.
stats-source = Source
stats-output = Output
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

## Status line

state-starting = Starting
state-running = Running
state-paused = Paused
state-stalled = No readings
state-stopped = Ended
typing-nowhere = Nothing is typed into other programs
typing-suppressed = Paused: nothing is typed into other programs at present
typing-into = Types into other programs: { $output }

message-ended = The session has ended. Everything is released.

## Recording

recording-play = Play
recording-pause = Pause
recording-first = First reading
recording-back = One reading back
recording-on = One reading on
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
recording-exported = { $count } readings are in { $file }
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
