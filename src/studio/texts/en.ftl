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

scope-presses = Presses
scope-lowest-fingertip = Lowest fingertip over the board

## Status line

message-ended = The session has ended. Everything is released.
