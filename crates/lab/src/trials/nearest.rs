//! The text of the nearest keys: what perfect detection of taps without a decoder would type.

use parry3d::math::Vec2;

use super::observed::{Stroke, StrokeKind};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::device::{EventKind, KeyAction, KeyCode, OutputEvent};
use crate::kinematics::HandPose;
use crate::layout::Layout;
use crate::readings::nearest_target;
use crate::sim::UsTextField;
use crate::time::Timestamp;

/// A text that is typed by pressing the nearest key of each tap, in the base layer. A modifier
/// applies to the next key. A multitap key types its first letter.
struct NearestText<'a> {
    layout: &'a Layout,
    field: UsTextField,
    modifier: Option<KeyCode>,
}

impl<'a> NearestText<'a> {
    fn new(layout: &'a Layout) -> Self {
        Self {
            layout,
            field: UsTextField::new(),
            modifier: None,
        }
    }

    /// Returns the text so far.
    fn text(&self) -> &str {
        self.field.text()
    }

    /// Presses the key that is nearest to a point of a target (metres from its center).
    fn tap(&mut self, target: TargetId, point: Vec2) {
        let Some((surface, meant)) = self.layout.scene.target(target) else {
            return;
        };
        let on_board = meant.surface_from_target * point.extend(0.0);
        let Some(nearest) = nearest_target(surface, on_board) else {
            return;
        };
        let key = self.layout.key_at(nearest);
        let action = key.and_then(|key| key.actions.first().copied().flatten());
        let letter = match action {
            Some(KeyAction::Multitap(id)) => {
                let multitap = self.layout.multitaps.keys.get(usize::from(id.0));
                multitap.and_then(|multitap| multitap.letters.first().copied())
            }
            other => other,
        };
        match letter {
            Some(KeyAction::Key(code)) => self.press(code),
            Some(KeyAction::Modifier(code, _)) => self.modifier = Some(code),
            _ => {}
        }
    }

    fn press(&mut self, code: KeyCode) {
        let modifier = self.modifier.take();
        modifier
            .into_iter()
            .for_each(|it| self.emit(EventKind::KeyDown(it)));
        self.emit(EventKind::KeyDown(code));
        self.emit(EventKind::KeyUp(code));
        modifier
            .into_iter()
            .for_each(|it| self.emit(EventKind::KeyUp(it)));
    }

    fn emit(&mut self, kind: EventKind) {
        self.field.handle(&OutputEvent {
            time: Timestamp::default(),
            kind,
        });
    }
}

/// Returns the text that the nearest keys of strokes type, by a point of each from the center of what is meant.
pub(super) fn text_of_nearest_keys(
    layout: &Layout,
    strokes: &[Stroke],
    point: fn(&Stroke) -> Vec2,
) -> String {
    let mut strokes: Vec<&Stroke> = strokes.iter().collect();
    strokes.sort_by(|a, b| a.bottom.total_cmp(&b.bottom));
    let mut text = NearestText::new(layout);
    for stroke in strokes {
        if stroke.kind != StrokeKind::Shallow {
            text.tap(stroke.target, point(stroke));
        }
    }
    text.text().to_owned()
}

/// Returns the point of the shown pad from the center of what a stroke means, in metres.
pub(super) fn shown_point(scene: &Scene, stroke: &Stroke, pose: &HandPose) -> Option<Vec2> {
    let (surface, target) = scene.target(stroke.target)?;
    let tip = pose.fingertip(stroke.finger)?;
    let on_surface = surface
        .world_from_surface(pose)?
        .inverse_transform_point(tip);
    let at = target
        .surface_from_target
        .inverse_transform_point(on_surface);
    Some(at.truncate())
}
