//! The arm as a pointer, as written → checked.

mod modes;

pub use modes::{Frame, Mode};

use parry3d::math::Vec2;
use serde::Deserialize;

use crate::contact::TargetId;
use crate::device::KeyAction;
use crate::device::pointer::{
    self, ClickMethod, DwellSettings, MAX_CLICKS, PinchGaps, PointerSettings,
};
use crate::device::value_output::ValueOutput;
use crate::document::DocumentError;
use crate::estimate::OneEuroSettings;
use crate::hand::{Dof, Finger, Side};
use crate::layout::builder::Checked;
use crate::layout::controls::Drives;
use crate::layout::model::metres;
use crate::layout::ranged::{
    Angle, CursorSpeed, Cutoff, DwellTime, Factor, Gain, Gap, PointerRadius, PushDepth, Screen,
    ScrollPixels, Steepness, Step,
};
use crate::layout::schema::Does;

/// What the pointer is called among the targets.
pub const POINTER: &str = "pointer";

/// How many pixels a screen has that is not told, and how far something is dragged: 3 mm of a hand
/// that has it all within some 200 mm.
const SCREEN: Vec2 = Vec2::new(1920.0, 1080.0);
const DRAG: f32 = 30.0;

/// The most knots of an acceleration.
const MOST_KNOTS: usize = 8;

/// A pointer as it stands in the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pointer<'a> {
    /// The hand that points; else the first that is seen.
    #[serde(default)]
    pub hand: Option<Side>,
    /// How it says where.
    pub mode: Mode,
    /// How the cursor moves.
    #[serde(default)]
    pub moves: Option<Moves>,
    /// How many pixels the whole range is.
    #[serde(default)]
    pub screen_px: Option<(Screen, Screen)>,
    /// The most that the cursor moves in a frame.
    #[serde(default)]
    pub max_step_px: Step,
    /// How the place is smoothed.
    #[serde(default)]
    pub smoothing: Smoothing,
    /// How far the hand goes before the cursor follows.
    #[serde(default)]
    pub dead_zone_px: PointerRadius,
    /// Speeds in pixels a second and the gains there.
    #[serde(default)]
    pub acceleration: Vec<(CursorSpeed, Gain)>,
    /// What makes it slow.
    #[serde(default)]
    pub precision: Option<Gesture>,
    /// How slow that is.
    #[serde(default)]
    pub precision_factor: Factor,
    /// What has to be held for the cursor to move.
    #[serde(default)]
    pub clutch: Option<Gesture>,
    /// When fingers pinch.
    #[serde(default)]
    pub pinch_mm: Option<Gaps>,
    /// What presses what.
    #[serde(borrow, default)]
    pub clicks: Vec<Click<'a>>,
    /// What is tapped where the cursor rests.
    #[serde(borrow, default)]
    pub dwell: Option<Rest<'a>>,
    /// How far the hand goes before something that is pressed is dragged.
    #[serde(default)]
    pub drag_px: Option<PointerRadius>,
    /// What makes a wheel of it.
    #[serde(default)]
    pub scroll: Option<Scroll>,
    /// What the third axis drives.
    #[serde(borrow, default)]
    pub z_drives: Option<Drives<'a>>,
}

/// How the cursor moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Moves {
    /// To places on the screen.
    To,
    /// By pixels.
    By,
    /// Not at all.
    Nothing,
}

/// How the place is smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Smoothing {
    /// As is good for most.
    #[default]
    Default,
    /// Not at all.
    Off,
    /// By a 1-Euro filter.
    OneEuro {
        /// At rest.
        min_cutoff_hz: Cutoff,
        /// How much it rises with the speed in pixels a second.
        beta: Steepness,
    },
}

/// Something that the hand does.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Gesture {
    /// The tips of thumb and finger meet.
    Pinch(Finger),
    /// A joint bends this far.
    Flexion(Dof, Angle),
}

/// What presses.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Press {
    /// The tips of thumb and finger meet.
    Pinch(Finger),
    /// A joint bends this far.
    Flexion(Dof, Angle),
    /// The index fingertip goes forward this far.
    Push(PushDepth),
}

/// How far apart fingertips are in a pinch.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gaps {
    /// Where it goes on.
    pub on: Gap,
    /// Where it goes off.
    pub off: Gap,
    /// Where its first sign is.
    pub ready: Gap,
}

/// What presses what.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Click<'a> {
    /// What presses.
    pub by: Press,
    /// What is pressed.
    #[serde(borrow)]
    pub does: Does<'a>,
}

/// What is tapped where the cursor rests.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rest<'a> {
    /// For how long it rests.
    pub ms: DwellTime,
    /// Within which circle.
    pub radius_px: PointerRadius,
    /// What is tapped.
    #[serde(borrow)]
    pub does: Does<'a>,
}

/// What makes a wheel of a pointer.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scroll {
    /// As long as it is on.
    pub by: Gesture,
    /// How far a click of the wheel is.
    pub px_per_click: ScrollPixels,
}

impl<'a> Checked<'a> {
    /// Checks the pointer of a layout; `target` is what it is among the targets.
    pub(in crate::layout) fn pointer(
        &mut self,
        written: &Pointer<'a>,
        target: TargetId,
    ) -> Result<PointerSettings, DocumentError> {
        let moves = written.moves.unwrap_or(match written.mode {
            Mode::Rate { .. } => Moves::By,
            _ => Moves::To,
        });
        self.refuse_gestures_twice(written)?;
        Ok(PointerSettings {
            target,
            side: written.hand,
            mode: self.mode(&written.mode)?,
            output: match moves {
                Moves::To => pointer::CursorOutput::Absolute,
                Moves::By => pointer::CursorOutput::Relative,
                Moves::Nothing => pointer::CursorOutput::None,
            },
            screen_px: written.screen_px.map_or(SCREEN, |(width, height)| {
                Vec2::new(width.get() as f32, height.get() as f32)
            }),
            max_step_px: written.max_step_px.get() as f32,
            smoothing: smoothing(written.smoothing),
            dead_zone_px: written.dead_zone_px.get() as f32,
            acceleration: self.acceleration(written, moves)?,
            precision_factor: written.precision_factor.get() as f32,
            precision_gesture: written.precision.map(|by| self.gesture(by)).transpose()?,
            clutch: written.clutch.map(|by| self.gesture(by)).transpose()?,
            pinch: self.gaps(written.pinch_mm)?,
            clicks: self.clicks(&written.clicks)?,
            dwell: self.dwell(written.dwell.as_ref())?,
            drag_threshold_px: written.drag_px.map_or(DRAG, |drag| drag.get() as f32),
            scroll: written.scroll.map(|it| self.scroll(it)).transpose()?,
            depth: self.depth(written)?,
        })
    }

    fn wrong<T>(&self, message: impl std::fmt::Display) -> Result<T, DocumentError> {
        Err(self.document.error_at(self.pointer_word(), message))
    }

    fn gesture(&self, written: Gesture) -> Result<pointer::Gesture, DocumentError> {
        Ok(match written {
            Gesture::Pinch(Finger::Thumb) => {
                return self.wrong("the thumb pinches with another finger, name that one");
            }
            Gesture::Pinch(finger) => pointer::Gesture::Pinch(finger),
            Gesture::Flexion(dof, angle) if angle.get().abs() < 5.0 => {
                return self.wrong(format!(
                    "`Flexion` of `{dof}` is 5° or more either way, so that it can go off"
                ));
            }
            Gesture::Flexion(dof, angle) => {
                pointer::Gesture::Flexion(dof, angle.get().to_radians() as f32)
            }
        })
    }

    /// Two of the same finger or joint would be on together.
    fn refuse_gestures_twice(&self, written: &Pointer) -> Result<(), DocumentError> {
        let clicks = written.clicks.iter().map(|click| click.by);
        let scroll = written.scroll.map(|scroll| scroll.by);
        let others = [written.clutch, written.precision, scroll];
        let others = others.into_iter().flatten().map(Press::from);
        let all: Vec<Press> = clicks.chain(others).collect();
        for (place, press) in all.iter().enumerate() {
            if all[..place].iter().any(|other| other.meets(press)) {
                let what = match press {
                    Press::Pinch(finger) => {
                        format!("two gestures are a pinch of the {finger} finger")
                    }
                    Press::Flexion(dof, _) => format!("two gestures bend `{dof}` the same way"),
                    Press::Push(_) => "two clicks are by `Push`".into(),
                };
                return self.wrong(format!("{what}: both would be on together"));
            }
        }
        Ok(())
    }

    fn acceleration(
        &self,
        written: &Pointer,
        moves: Moves,
    ) -> Result<Vec<(f32, f32)>, DocumentError> {
        let knots = &written.acceleration;
        if !knots.is_empty() && moves != Moves::By {
            return self.wrong("`acceleration` is for a pointer that `moves: By` pixels");
        }
        if knots.len() > MOST_KNOTS {
            let message = format!("`acceleration` has at most {MOST_KNOTS} knots");
            return self.wrong(message);
        }
        if knots.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
            return self.wrong("the speeds of `acceleration` go up from knot to knot");
        }
        let knots = knots.iter();
        Ok(knots
            .map(|(speed, gain)| (speed.get() as f32, gain.get() as f32))
            .collect())
    }

    fn gaps(&self, written: Option<Gaps>) -> Result<PinchGaps, DocumentError> {
        let Some(Gaps { on, off, ready }) = written else {
            return Ok(PinchGaps::default());
        };
        if !(on < off && off < ready) {
            return self.wrong("in `pinch_mm` `on` is less than `off`, and that less than `ready`");
        }
        let [on, off, ready] = [on, off, ready].map(|gap| metres(gap.get()));
        Ok(PinchGaps {
            on,
            off,
            near: ready,
        })
    }

    fn clicks(
        &mut self,
        written: &[Click<'a>],
    ) -> Result<Vec<(ClickMethod, KeyAction)>, DocumentError> {
        if written.len() > MAX_CLICKS {
            return self.wrong(format!("a pointer has at most {MAX_CLICKS} clicks"));
        }
        let mut clicks = Vec::new();
        for click in written {
            let by = match click.by {
                Press::Pinch(finger) => ClickMethod::Gesture(self.gesture(Gesture::Pinch(finger))?),
                Press::Flexion(dof, angle) => {
                    ClickMethod::Gesture(self.gesture(Gesture::Flexion(dof, angle))?)
                }
                Press::Push(depth) => ClickMethod::Push(metres(depth.get())),
            };
            clicks.push((by, self.action(click.does, None)?));
        }
        Ok(clicks)
    }

    fn dwell(
        &mut self,
        written: Option<&Rest<'a>>,
    ) -> Result<Option<(DwellSettings, KeyAction)>, DocumentError> {
        let Some(rest) = written else {
            return Ok(None);
        };
        let dwell = DwellSettings {
            duration: std::time::Duration::from_secs_f64(rest.ms.get() * 1e-3),
            radius_px: rest.radius_px.get() as f32,
        };
        Ok(Some((dwell, self.action(rest.does, None)?)))
    }

    fn scroll(&self, written: Scroll) -> Result<pointer::ScrollSettings, DocumentError> {
        let pixels = written.px_per_click.get() as f32;
        if pixels.abs() < 1.0 {
            return self.wrong("`px_per_click` is 1 px or more either way");
        }
        let by = self.gesture(written.by)?;
        Ok(pointer::ScrollSettings {
            gesture: by,
            px_per_detent: pixels,
        })
    }

    fn depth(&mut self, written: &Pointer<'a>) -> Result<Option<ValueOutput>, DocumentError> {
        if written.z_drives.is_none() {
            return Ok(None);
        }
        match &written.mode {
            Mode::Direct { .. } => {}
            Mode::Joint { z: Some(_), .. } => {}
            _ => return self.wrong("`z_drives` is for `Direct`, and for `Joint` with a `z`"),
        }
        self.drive(written.z_drives).map(Some)
    }
}

impl From<Gesture> for Press {
    fn from(gesture: Gesture) -> Self {
        match gesture {
            Gesture::Pinch(finger) => Self::Pinch(finger),
            Gesture::Flexion(dof, angle) => Self::Flexion(dof, angle),
        }
    }
}

impl Press {
    fn meets(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Pinch(one), Self::Pinch(other)) => one == other,
            (Self::Flexion(one, at), Self::Flexion(other, there)) => {
                one == other && at.get().signum() == there.get().signum()
            }
            (Self::Push(_), Self::Push(_)) => true,
            _ => false,
        }
    }
}

/// 1 Hz at rest; 0.01 Hz per px/s is the 0.1 Hz per mm/s that lags 12 ms, where a millimetre of the hand
/// is 10 px.
fn smoothing(written: Smoothing) -> Option<OneEuroSettings> {
    let (min_cutoff_hz, beta) = match written {
        Smoothing::Off => return None,
        Smoothing::Default => (1.0, 0.01),
        Smoothing::OneEuro {
            min_cutoff_hz,
            beta,
        } => (min_cutoff_hz.get(), beta.get()),
    };
    Some(OneEuroSettings {
        min_cutoff_hz,
        beta,
        derivative_cutoff_hz: 1.0,
    })
}
