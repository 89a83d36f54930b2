# The words on the screen of Studio. The same keys stand in es.ftl.

window-title = Ademán Studio

## Toolbar

button-pause = Pause
button-resume = Resume
button-recenter = Recenter
button-zero = Zero
hint-pause = Release everything and suppress all events, or go on (P)
hint-recenter = Move the boards below the index fingertip (C)
hint-zero = Rest the hand first: its present angles become those of its rest pose (Z)
menu-view = View
view-eye = From the eye
view-above = From above
view-side = From the side
view-bones = Bones and joints
view-dark = Dark
panel-sensors = Sensors
panel-scope = Scope

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
