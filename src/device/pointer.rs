//! The arm as a pointer in space: it moves the cursor of the screen, clicks, drags, scrolls, and selects
//! targets in space.

mod cursor;
mod direct;
mod dwell;
mod anchored_frame;
mod gesture;
mod gesture_set;
mod joint;
pub mod mode;
mod push;
mod rate;
mod ray;
mod settings;
mod trusted_hand;
mod selection;
mod motion;

pub use anchored_frame::AnchoredFrame;
pub use dwell::DwellSettings;
pub use gesture::{Gesture, PinchGaps};
pub use mode::PointingMode;
pub use selection::SelectionSpace;
pub use settings::{ClickMethod, CursorOutput, MAX_CLICKS, PointerSettings, ScrollSettings};

use parry3d::math::{Vec2, Vec3};

use self::cursor::Cursor;
use self::dwell::Resting;
use self::gesture_set::Gestures;
use self::mode::Aim;
use self::motion::Way;
use self::selection::{At, Selector};
use self::trusted_hand::Sight;
use super::value_output::Driver;
use super::{
    Capabilities, Capability, DeviceInput, DeviceOutput, EventKind, KeyAction, PressSource,
    VirtualDevice,
};
use crate::hand::{Finger, Side};
use crate::time::Timestamp;

/// A click of the wheel in the units of [`Action::Scroll`].
const CLICK: f32 = 120.0;

/// The most that the wheel is behind, in those units: what finds no room is made up for up to there.
const MOST_BEHIND: f32 = 20.0 * CLICK;

/// The longest time between two frames that counts, in seconds; after a longer gap a rate has not moved
/// the pointer all the while.
const LONGEST_GAP: f32 = 0.1;

/// The part of a clicking owner that is none of the gestures.
const DWELL: u8 = u8::MAX;

/// What one hand points at: on the screen, where the layout has a pointer, and in space.
///
/// The first hand that is seen points, unless the settings name one; until everything is let go of. All
/// gestures are latched. When the hand, or what the mode needs of it, is lost, in doubt or has jumped,
/// they are cancelled, and each has to be seen off before it counts again.
pub struct Pointer {
    cursor: Option<Hand>,
    selector: Selector,
    /// The hand that points.
    side: Option<Side>,
}

/// What moves the cursor.
struct Hand {
    settings: PointerSettings,
    way: Way,
    cursor: Cursor,
    gestures: Gestures,
    resting: Resting,
    /// How far the hand moved since a button went down, in pixels.
    swallowed: Vec2,
    is_dragging: bool,
    /// What of the wheel's way has not gone out, in 120ths of a click.
    scrolled: Vec2,
    depth: Option<Driver>,
    /// When it was seen last, unless it was lost since then.
    time: Option<Timestamp>,
}

impl Pointer {
    /// One that has seen nothing yet. Without settings there is no cursor, and the index fingertip
    /// selects targets in space.
    pub fn new(settings: Option<PointerSettings>, spaces: Vec<SelectionSpace>) -> Self {
        Self {
            cursor: settings.map(Hand::new),
            selector: Selector::new(spaces),
            side: None,
        }
    }

    /// Whether a hand is the one that points.
    fn points(&mut self, side: Side) -> bool {
        let named = self.cursor.as_ref().and_then(|hand| hand.settings.side);
        side == named.unwrap_or(*self.side.get_or_insert(side))
    }
}

impl Hand {
    fn new(settings: PointerSettings) -> Self {
        let rest = 0.5;
        Self {
            way: Way::new(&settings),
            cursor: Cursor::new(&settings),
            gestures: Gestures::new(&settings),
            resting: Resting::default(),
            swallowed: Vec2::ZERO,
            is_dragging: false,
            scrolled: Vec2::ZERO,
            depth: settings
                .depth
                .map(|drive| Driver::new(settings.target, drive, rest)),
            time: None,
            settings,
        }
    }

    /// Takes a frame; `false` when the hand points nowhere.
    fn follow(&mut self, sight: &Sight, out: &mut DeviceOutput) -> bool {
        let time = sight.pose().time;
        let before = self.time.replace(time).unwrap_or(time);
        let seconds = time.since(before).as_secs_f32().min(LONGEST_GAP);
        let aim = match sight.jumped() {
            true => None,
            false => self.settings.mode.aim(sight),
        };
        let Some(aim) = aim else {
            self.lose(time, out);
            return false;
        };
        self.gestures
            .follow(sight, &self.settings, seconds, time, out);
        self.move_along(aim, seconds, time, out);
        self.click_at_rest(time, out);
        if let (Some(depth), Aim::At(_)) = (&mut self.depth, aim) {
            depth.set((self.cursor.shares().z * 1e3).round() / 1e3, time, out);
        }
        true
    }

    fn move_along(&mut self, aim: Aim, seconds: f32, time: Timestamp, out: &mut DeviceOutput) {
        let moved = self.way.follow(aim, seconds);
        if self.gestures.scrolls() {
            self.cursor.hold();
            self.scroll(moved.by.truncate(), time, out);
        } else if self.is_still(moved.by, out) {
            self.cursor.hold();
        } else if let Some(place) = moved.starts_at
            && !self.gestures.has_clutch()
        {
            self.cursor.put(place);
        } else {
            let gain = self.gain(moved.by.truncate(), seconds, out);
            self.cursor.advance(moved.by * gain, self.way.place());
        }
        self.cursor.put_if_new(self.way.place());
        self.cursor.tell(time, out);
    }

    /// Whether the cursor stays where it is however the hand moves.
    fn is_still(&mut self, by: Vec3, out: &DeviceOutput) -> bool {
        let is_clicking = self.gestures.presses();
        if !is_clicking {
            self.swallowed = Vec2::ZERO;
            self.is_dragging = false;
        }
        if self.gestures.is_let_go() || out.arbiter.is_pressed(KeyAction::Clutch) {
            return true;
        }
        if is_clicking && !self.is_dragging {
            self.swallowed += by.truncate();
            self.is_dragging = self.swallowed.length() > self.settings.drag_threshold_px;
            return true;
        }
        !is_clicking && self.gestures.is_ready()
    }

    fn gain(&self, by: Vec2, seconds: f32, out: &DeviceOutput) -> f32 {
        let is_precise = self.gestures.is_precise() || out.arbiter.is_pressed(KeyAction::Precision);
        let precision = if is_precise {
            self.settings.precision_factor
        } else {
            1.0
        };
        let speed = if seconds > 0.0 {
            by.length() / seconds
        } else {
            0.0
        };
        precision * settings::gain(&self.settings.acceleration, speed)
    }

    fn scroll(&mut self, by: Vec2, time: Timestamp, out: &mut DeviceOutput) {
        let Some(scroll) = self.settings.scroll else {
            return;
        };
        let most = Vec2::splat(MOST_BEHIND);
        self.scrolled = (self.scrolled + by * (CLICK / scroll.px_per_detent)).clamp(-most, most);
        let whole = self.scrolled.trunc();
        let action = EventKind::Scroll(whole.x as i32, whole.y as i32);
        if whole != Vec2::ZERO && out.emit(time, action) {
            self.scrolled -= whole;
        }
    }

    fn click_at_rest(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        let Some((dwell, action)) = self.settings.dwell else {
            return;
        };
        if self.gestures.presses() || self.gestures.scrolls() {
            self.resting = Resting::default();
            return;
        }
        let at = self.cursor.way();
        if self.resting.clicks(dwell, at, time) {
            out.tap(PressSource::Part(self.settings.target, DWELL), action, time);
        }
    }

    /// The hand, or what the mode needs of it, is not seen.
    fn lose(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.gestures.lose(self.settings.target, time, out);
        self.way.forget();
        self.time = None;
        self.resting = Resting::default();
        self.scrolled = Vec2::ZERO;
        self.cursor.hold();
        if let Some(depth) = &mut self.depth {
            depth.rest(time, out);
        }
    }

    /// Where it is in space.
    fn point(&self) -> Option<At> {
        match &self.settings.mode {
            PointingMode::Joint(joints) => {
                Some(At::InEachSpace(joints.point(self.cursor.shares())))
            }
            _ => None,
        }
    }
}

impl VirtualDevice for Pointer {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        self.selector.add_needs(needs);
        let Some(Hand { settings, .. }) = &self.cursor else {
            return;
        };
        match settings.output {
            CursorOutput::Absolute => needs.insert(Capability::AbsoluteMotion),
            CursorOutput::Relative => needs.insert(Capability::RelativeMotion),
            CursorOutput::None => {}
        }
        if settings.scroll.is_some() {
            needs.insert(Capability::Scroll);
        }
        if let Some(drive) = settings.depth {
            drive.add_capabilities(needs);
        }
        let dwell = settings.dwell.iter().map(|(_, action)| action);
        let clicks = settings
            .clicks
            .iter()
            .map(|(_, action)| action)
            .chain(dwell);
        needs.extend(clicks.filter_map(|action| action.required_capability()));
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        if !self.points(seen.pose.side) {
            return;
        }
        let sight = Sight::of(seen);
        let is_pointing = match &mut self.cursor {
            Some(hand) => hand.follow(&sight, out),
            None => !sight.jumped(),
        };
        let point = match &self.cursor {
            _ if !is_pointing => None,
            Some(hand) if hand.point().is_some() => hand.point(),
            _ => sight.tip(Finger::Index).map(At::InTheWorld),
        };
        self.selector.follow(point, seen.pose, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        if let Some(hand) = &mut self.cursor {
            hand.lose(time, out);
        }
        self.selector.lose(time, out);
        self.side = None;
    }
}
