//! A tour of a layout: a script that uses each control once.

use std::fmt::Write;
use std::time::Duration;

use parry3d::math::Vec3;

use super::disturbance;
use crate::contact::TargetId;
use crate::contact::surface::Anchor;
use crate::device::pointer::Gesture;
use crate::device::trigger::{HandShape, Measure, Trigger};
use crate::estimate::BendRanges;
use crate::hand::{Finger, Input, Joint};
use crate::layout::{Control, Fit, Handle, Layout};

/// Rest between two controls, in ms.
const PAUSE_MS: u32 = 200;
/// Turn of a knob, in degrees.
const TURN_DEG: u32 = 90;
/// Part of a control that a drag uses: the fingertip stays inside.
const INNER: f32 = 0.8;
/// Angle by which a trigger is passed, in degrees.
const BEYOND_DEG: f32 = 5.0;
/// Angle by which a clutch is let go, in degrees: it is off 10° before its threshold.
const LET_GO_DEG: f32 = 15.0;
/// Steps in which the place of a point before its fit to the hand is found. The fit moves it by some centimetres, and neighbors alike.
const FIT_STEPS: usize = 4;
/// Value by which an input is beyond its threshold.
const HOLD_BEYOND: f32 = 0.2;
/// Time for which an input is held, in ms.
const HOLD_MS: u32 = 200;

/// Bend of a finger that has no part in a shape, as a fraction of its range.
const BETWEEN: f32 = 0.4;

/// A part of a tour: one control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TourStop {
    /// The name of the control.
    pub name: String,
    /// The actions, as in a script.
    pub actions: String,
}

/// The names of stops that move a cursor.
const STICK: &str = "the stick";
const ARM: &str = "the arm";

impl TourStop {
    /// Returns `true` if the stop only moves a cursor or passes through space.
    pub(crate) fn moves_cursor(&self) -> bool {
        [STICK, ARM].contains(&self.name.as_str())
    }
}

/// Returns the stops of a tour: each control is touched once, sliders are moved along their travel, knobs are turned, joints are bent
/// for the triggers. Leaves out what ends or pauses the session or changes the layout, and what no script can name.
pub fn tour(layout: &Layout) -> Vec<TourStop> {
    let disturbing = disturbance::targets(layout);
    let keys = layout.keys.iter();
    let keys = keys.filter(|key| !disturbing.contains(&key.face.target));
    let keys = keys.filter_map(|key| tap(&key.face.name));
    let controls = layout.controls.iter();
    let controls = controls.filter(|control| {
        let mut faces = control.faces.iter();
        !faces.any(|face| disturbing.contains(&face.target))
    });
    let controls = controls.flat_map(control_stops);
    let triggers = layout.triggers.iter();
    let triggers = triggers.filter(|(_, trigger)| !disturbing.contains(&trigger.target));
    let triggers = triggers.filter_map(|(name, trigger)| {
        let actions = trigger_actions(layout, trigger)?;
        let name = name.clone();
        Some(TourStop { name, actions })
    });
    let mut stops: Vec<TourStop> = keys.chain(controls).chain(triggers).collect();
    match &layout.pointer {
        Some(pointer) if pointer.mode.starts_at_rest() => stops.extend(stick_stops()),
        None if layout.spaces.is_empty() => {}
        _ if disturbance::is_in_space(layout) => {}
        _ => stops.extend(arm_stops()),
    }
    stops
}

/// Returns the stops of a tour that shows what a pointer and targets in space do: a clutch is held while the arm moves the cursor, and
/// without a pointer the index fingertip goes to each target with the anchor `elbow`, in place of movements that meet it by chance.
pub fn aimed_tour(layout: &Layout) -> Vec<TourStop> {
    let mut stops = tour(layout);
    let clutch = layout.pointer.as_ref().and_then(|pointer| pointer.clutch);
    if let Some(Gesture::Flexion(dof, on)) = clutch
        && let Some(first) = stops.iter().position(TourStop::moves_cursor)
    {
        let bent = |degrees: f32| {
            let angle = on.to_degrees() + degrees * on.signum();
            arm_stop(format!("set {} {angle:.0}", dof.name()))
        };
        stops.insert(first, bent(BEYOND_DEG));
        stops.push(bent(-LET_GO_DEG));
    }
    let aimed = aimed_stops(layout);
    if !aimed.is_empty() {
        stops.retain(|stop| !stop.moves_cursor());
        stops.extend(aimed);
    }
    stops
}

/// Returns a script of these stops.
pub fn tour_text(layout: &Layout, stops: &[TourStop]) -> String {
    let title: String = layout.name.chars().filter(|it| !it.is_control()).collect();
    let mut text = format!("# A tour of {title}: each control once.\n");
    if stops.is_empty() {
        text.push_str("wait 1000   # the layout has no control that the hand can use\n");
    }
    for stop in stops {
        _ = writeln!(text, "{}; wait {PAUSE_MS}", stop.actions);
    }
    text
}

fn tap(name: &str) -> Option<TourStop> {
    stop(name, |quoted| format!("tap {quoted}"))
}

fn stop(name: &str, actions: impl Fn(&str) -> String) -> Option<TourStop> {
    Some(TourStop {
        name: name.to_owned(),
        actions: actions(&quoted(name)?),
    })
}

/// Returns a name as a script writes it; `None` for one with both kinds of quotes or a line break.
fn quoted(name: &str) -> Option<String> {
    let is_plain = |c: char| !c.is_whitespace() && !matches!(c, ';' | '&' | '#' | '"' | '\'');
    match name {
        _ if name.contains(['\n', '\r']) => None,
        _ if !name.is_empty() && name.chars().all(is_plain) => Some(name.to_owned()),
        _ if !name.contains('"') => Some(format!("\"{name}\"")),
        _ if !name.contains('\'') => Some(format!("'{name}'")),
        _ => None,
    }
}

fn control_stops(control: &Control) -> Vec<TourStop> {
    let first = control.faces.first();
    let half = first.map_or(0.0, |face| face.outline.half_extents().min_element());
    let drag = |actions: String| {
        let face = first.into_iter();
        let stops =
            face.filter_map(|face| stop(&face.name, |name| format!("press {name}{actions}")));
        stops.collect()
    };
    match control.kind.handle() {
        Handle::Switch => {
            let faces = control.faces.iter();
            faces.filter_map(|face| tap(&face.name)).collect()
        }
        Handle::Line { half_length } => {
            let end = millimetres(half_length * INNER);
            drag(format!(
                " {} 0; slide {} 0; slide {} 0; lift",
                -end,
                2 * end,
                -end
            ))
        }
        Handle::Turn { radius, .. } => {
            let rim = millimetres(radius);
            drag(format!(" {rim} 0; arc -{TURN_DEG}; arc {TURN_DEG}; lift"))
        }
        Handle::Stick { half: reach } => {
            let end = millimetres(reach);
            drag(format!(
                "; slide {end} 0; slide -{end} 0; slide 0 {end}; slide 0 -{end}; lift"
            ))
        }
        Handle::Pad { half: area } => {
            let [x, y] = (area * INNER).to_array().map(millimetres);
            drag(format!(
                " -{x} -{y}; slide {} 0; slide 0 {}; slide -{} 0; lift",
                2 * x,
                2 * y,
                2 * x
            ))
        }
        Handle::Area => {
            let end = millimetres(half * INNER * 0.5);
            drag(format!(
                " -{end} 0; slide {} 0; slide 0 {end}; lift",
                2 * end
            ))
        }
    }
}

/// Returns the movements that turn a trigger on and off.
fn trigger_actions(layout: &Layout, trigger: &Trigger) -> Option<String> {
    Some(match trigger.measure {
        Measure::Angle(dof) => {
            let beyond = BEYOND_DEG.copysign(trigger.on - trigger.off);
            let (on, off) = (trigger.on.to_degrees(), trigger.off.to_degrees());
            let joint = dof.name();
            format!(
                "set {joint} {:.0}; set {joint} {:.0}",
                on + beyond,
                off - beyond
            )
        }
        Measure::Pinch(Finger::Index) => "pinch; unpinch".to_owned(),
        Measure::Input(input) => {
            let name = input.name();
            let held = trigger.held.map(Input::name);
            let hold = |value| held.map_or(String::new(), |held| format!("input {held} {value}; "));
            format!(
                "{}input {name} {:.2}; wait {HOLD_MS}; input {name} 0; {}wait {HOLD_MS}",
                hold(1),
                trigger.on + HOLD_BEYOND.copysign(trigger.on - trigger.off),
                hold(0),
            )
        }
        Measure::Body(angle) => {
            let (on, off) = (trigger.on.to_degrees(), trigger.off.to_degrees());
            let beyond = BEYOND_DEG.copysign(on - off);
            let name = angle.name();
            format!(
                "input {name} {:.0}; wait {HOLD_MS}; input {name} {:.0}; wait {HOLD_MS}",
                on + beyond,
                off - beyond
            )
        }
        Measure::HandShape(shape) => shape_actions(shape, trigger.hold),
        Measure::Sequence(steps) => {
            let step = |target: &TargetId| {
                let mut triggers = layout.triggers.iter();
                let (_, step) = triggers.find(|(_, it)| it.target == *target)?;
                trigger_actions(layout, step)
            };
            let actions: Option<Vec<String>> = steps.targets.iter().flatten().map(step).collect();
            actions?.join("; ")
        }
        // A swipe, a shake and a circle are faster than the hand of a script.
        Measure::Pinch(_) | Measure::Swipe(_) | Measure::Shake | Measure::Circle(..) => {
            return None;
        }
    })
}

/// Returns the movements of the fingers to a shape, for as long as it is held, and back.
fn shape_actions(shape: HandShape, hold: Duration) -> String {
    let ranges = BendRanges::human();
    let fingers = |bend: &dyn Fn(Finger) -> f32| {
        let fingers = Finger::ALL.iter();
        let joints = fingers.flat_map(|&finger| ranges.angles_at(finger, f64::from(bend(finger))));
        let joints = joints.map(|(dof, radians)| format!("set {dof} {:.0}", radians.to_degrees()));
        joints.collect::<Vec<_>>().join(" & ")
    };
    let shown = fingers(&|finger| shape.bend(finger).unwrap_or(BETWEEN));
    let rest = fingers(&|_| BETWEEN);
    let milliseconds = hold.as_millis() + u128::from(HOLD_MS);
    format!("{shown}; wait {milliseconds}; {rest}; wait {HOLD_MS}")
}

/// Returns movements of the stick of a glove, which move a cursor.
fn stick_stops() -> impl Iterator<Item = TourStop> {
    let moves = [
        "stick-x 1",
        "stick-x -1",
        "stick-x 0",
        "stick-y 1",
        "stick-y -1",
        "stick-y 0",
    ];
    moves.into_iter().map(|actions| TourStop {
        name: STICK.to_owned(),
        actions: format!("input {actions}; wait {HOLD_MS}"),
    })
}

/// Returns movements of the arm, which position a cursor and pass through targets in space.
fn arm_stops() -> impl Iterator<Item = TourStop> {
    let moves = [
        "set elbow-flexion 45",
        "set wrist-flexion -10",
        "set wrist-flexion 5",
        "set wrist-deviation 10",
        "set wrist-deviation 0",
        "set elbow-flexion 34",
    ];
    moves
        .into_iter()
        .map(|actions| arm_stop(actions.to_owned()))
}

fn arm_stop(actions: String) -> TourStop {
    TourStop {
        name: ARM.to_owned(),
        actions,
    }
}

/// Returns movements of the index fingertip to targets in space. None if one of them does what a tour leaves out: the fingertip passes
/// through others on its way.
fn aimed_stops(layout: &Layout) -> Vec<TourStop> {
    if layout.pointer.is_some() || disturbance::is_in_space(layout) {
        return Vec::new();
    }
    let elbow = Anchor::Joint(Joint::Elbow);
    let spaces = layout.spaces.iter();
    let spaces = spaces.filter(|targets| targets.space.frame.anchor == elbow);
    let mut stops = Vec::new();
    for targets in spaces {
        let elbow_from_frame = targets.space.frame.anchor_from_frame;
        for (name, volume) in targets.names.iter().zip(targets.space.volumes.iter()) {
            let center = elbow_from_frame.transform_point(volume.center);
            let Vec3 { x, y, z } = (unfitted(&layout.fit, center) * 1e3).round();
            stops.push(TourStop {
                name: name.clone(),
                actions: format!("point {x} {y} {z}"),
            });
        }
    }
    stops
}

/// Returns the position that [`Fit::position_from_elbow`] moves to `point`.
fn unfitted(fit: &Fit, point: Vec3) -> Vec3 {
    (0..FIT_STEPS).fold(point, |position, _| {
        point - (fit.position_from_elbow(position) - position)
    })
}

fn millimetres(metres: f32) -> i32 {
    ((metres * 1e3).floor() as i32).max(1)
}
