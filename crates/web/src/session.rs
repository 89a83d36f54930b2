//! The session of a page.

use std::sync::Arc;
use std::time::Duration;

use ademan_core::capture::{Reading, Sample};
use ademan_core::contact::{Phase, TargetId};
use ademan_core::device::Events;
use ademan_core::document::{Document, DocumentError, shipped_layouts};
use ademan_core::estimate::{Estimator, EstimatorSettings};
use ademan_core::hand::{JointAngles, Side};
use ademan_core::kinematics::{ArmModel, HandPose, half_bent_fingers};
use ademan_core::layout::{Fit, Layout, Person};
use ademan_core::objects::{EventObject, SceneState, TouchObject, layout_object, write_pose};
use ademan_core::pipeline::{LayoutInstance, Pipeline, PipelineSettings, PressFilter};
use ademan_core::snapshot::{Stats, StepView};
use ademan_core::time::Timestamp;
use ademan_lab::sim::{HandTask, Pointed, PointerHand, Script, UsTextField};
use serde::Serialize;

use crate::faults::{Fault, fault, faults};
use crate::hand::{FollowedHand, Hand, HandState, PERIOD, SimulatedPerson};
use crate::live::{Live, MAX_SILENCE};
use crate::objects::Lines;
use crate::plan::{PlanBoard, PlanEdit, edit_targets, plan};
use crate::words::Words;

/// The name of the layout in messages.
pub(crate) const NAME: &str = "layout.ron";

/// Longest time that one call catches up with: a browser does not run a page in the background.
const MAX_ELAPSED: Duration = Duration::from_millis(100);

/// Most bytes of text that the text field keeps.
const MAX_TEXT_BYTES: usize = 4096;

/// The time of the first reading. It is not 0, so that a hand may show earlier times.
pub(crate) const START: Timestamp = Timestamp(1_000_000);

/// The session of a page: a layout, hands, and what they type.
pub struct PageSession {
    pub(crate) right: ArmModel,
    pub(crate) left: ArmModel,
    /// The readings of the hands at rest.
    pub(crate) idle: [(Side, Sample); Side::COUNT],
    /// `true` if no hand was seen on this layout yet, so that its boards have no places in the world.
    is_unseen: bool,
    pub(crate) fit: Fit,
    pub(crate) layout: Arc<Layout>,
    person: Person,
    pub(crate) pipeline: Pipeline,
    pub(crate) hand: Hand,
    pub(crate) scene: SceneState,
    field: UsTextField,
    pub(crate) time: Timestamp,
    /// Elapsed time for which no reading was made yet.
    rest: Duration,
    /// The poses of the hands since the last call, by side.
    poses: [Option<HandPose>; Side::COUNT],
    /// Length of the typed text, in characters, when the task of the simulated person began.
    typed_before: usize,
    pub(crate) live: Live,
    pub(crate) lines: Lines,
    pub(crate) words: Words,
    buffer: Vec<u8>,
}

/// A message to the page about a layout.
#[derive(Serialize)]
struct LayoutNews<'a> {
    faults: Vec<Fault>,
    #[serde(skip_serializing_if = "Option::is_none")]
    plan: Option<Vec<PlanBoard<'a>>>,
}

/// A message to the page about the hands.
#[derive(Serialize)]
struct SessionNews<'a> {
    hand: HandState,
    text: &'a str,
}

impl PageSession {
    /// Creates a session with a layout, whose hands rest. Fails if the layout or what comes with the program is invalid.
    pub fn new(layout: &str) -> Result<Self, DocumentError> {
        let arm = ArmModel::parse(&Document::shipped("unam")?)?;
        let [right, left] = [Side::Right, Side::Left].map(|side| arm.clone().for_side(side));
        let fit = Fit::new(&right, Some(&left))?;
        let layout = Arc::new(Layout::for_hands(Document::new(NAME, layout), fit)?);
        let idle = [&right, &left].map(|own| (own.side(), PointerHand::new(own).advance(0.0)));
        Ok(Self {
            pipeline: new_pipeline(&right, &left, LayoutInstance::from_layout(&layout)),
            idle,
            is_unseen: true,
            right,
            left,
            fit,
            layout,
            person: Person::default(),
            hand: Hand::Resting,
            scene: SceneState::default(),
            field: UsTextField::with_capacity(MAX_TEXT_BYTES),
            time: START,
            rest: Duration::ZERO,
            poses: [None; Side::COUNT],
            typed_before: 0,
            live: Live::default(),
            lines: Lines::default(),
            words: Words::default(),
            buffer: Vec::new(),
        })
    }

    /// Replaces the layout, unless the text has faults. A simulated person continues with the rest of its text. Returns lines: the
    /// faults and the boards in the plane, and the object of the layout.
    pub fn set_layout(&mut self, text: &str) -> String {
        match self.layout_of(text) {
            Ok(layout) => {
                self.adopt(Arc::new(layout));
                // The boards have their places in the world once a hand is seen.
                self.layout_lines() + &self.advance(PERIOD)
            }
            Err(error) => {
                let news = LayoutNews {
                    faults: faults(&error),
                    plan: None,
                };
                self.lines.add("faults", news);
                self.lines.take()
            }
        }
    }

    /// Returns the lines of the layout in use, as [`set_layout`](Self::set_layout) does.
    pub fn layout_lines(&mut self) -> String {
        let news = LayoutNews {
            faults: Vec::new(),
            plan: Some(plan(&self.layout)),
        };
        self.lines.add("faults", news);
        let object = layout_object(&self.layout);
        self.lines.bytes_mut().extend_from_slice(&object);
        self.lines.take()
    }

    pub(crate) fn adopt(&mut self, layout: Arc<Layout>) {
        self.lose_hands();
        let mut events = Events::new();
        let mut instance = self.words.instance(&layout);
        self.pipeline.replace_profile(0, &mut instance, &mut events);
        self.layout = layout;
        self.is_unseen = true;
        self.write_events(&events);
        if let Hand::Simulated(person) = &self.hand {
            let typed = self.field.text().chars().count();
            let task = rest_of(&person.task, typed.saturating_sub(self.typed_before));
            self.simulate(task);
        }
    }

    /// Returns the text after an edit of the layout in use in the plane, which is not adopted, or the reason why it is not made.
    pub fn edit(&self, targets: &[TargetId], edit: PlanEdit) -> Result<String, String> {
        edit_targets(&self.layout.text, targets, edit).map_err(|error| error.to_string())
    }

    /// Replaces the simulated person: `text` is a person file, or empty for a person without errors. Returns the faults of the file.
    pub fn set_person(&mut self, text: &str) -> Vec<Fault> {
        if text.is_empty() {
            self.person = Person::default();
            return Vec::new();
        }
        match Person::parse(&Document::new("person.ron", text)) {
            Ok(person) => {
                self.person = person;
                Vec::new()
            }
            Err(error) => faults(&error),
        }
    }

    /// Starts a simulated person who types a text as far as the layout permits. Returns the reasons why that is not possible.
    pub fn type_text(&mut self, text: &str) -> Vec<Fault> {
        self.simulate(HandTask::text(text.to_owned()))
    }

    /// Starts a simulated person who plays a script. Returns the faults of the script.
    pub fn play(&mut self, script: &str) -> Vec<Fault> {
        match Script::from_text(script, &self.layout.target_names()) {
            Ok(script) => self.simulate(HandTask::Script(script)),
            Err(error) => faults(&error),
        }
    }

    fn simulate(&mut self, mut task: HandTask) -> Vec<Fault> {
        self.release();
        if let HandTask::Text { finds_letters, .. } = &mut task {
            let filter = self.pipeline.layout().filter();
            *finds_letters = filter.is_some_and(PressFilter::finds_letters);
        }
        let mut arms = vec![self.right.clone()];
        if self.layout.uses_hand(Side::Left) {
            arms.push(self.left.clone());
        }
        match SimulatedPerson::new(task, &self.layout, &arms, &self.person) {
            Ok(person) => {
                self.hand = Hand::Simulated(Box::new(person));
                self.typed_before = self.field.text().chars().count();
                Vec::new()
            }
            Err(error) => {
                self.hand = Hand::Resting;
                vec![fault(error)]
            }
        }
    }

    /// Points at something with the index finger of a hand.
    pub fn point(&mut self, side: Side, pointed: Pointed) {
        if !matches!(&self.hand, Hand::Pointing(hand) if hand.side() == side) {
            self.release();
            let hand = PointerHand::new(match side {
                Side::Right => &self.right,
                Side::Left => &self.left,
            });
            self.hand = Hand::Pointing(Box::new(hand));
        }
        if let Hand::Pointing(hand) = &mut self.hand {
            hand.point(pointed);
        }
    }

    /// Receives bytes of a sensor, which move the hands. Returns the number of readings in them.
    pub fn push(&mut self, protocol: &str, bytes: &[u8]) -> Result<usize, String> {
        if !matches!(&self.hand, Hand::Followed(hand) if hand.is_of(protocol, false)) {
            let hand = FollowedHand::new(protocol)?;
            self.release();
            self.follow(hand);
        }
        match &mut self.hand {
            Hand::Followed(hand) => Ok(hand.push(bytes, self.time)),
            _ => Ok(0),
        }
    }

    /// Replays the bytes of a recording, in place of the previous one. Returns the number of readings and, if some were left out, the
    /// error.
    pub fn play_file(
        &mut self,
        protocol: &str,
        bytes: &[u8],
    ) -> Result<(usize, Option<String>), String> {
        let (hand, error) = FollowedHand::of_file(protocol, bytes, self.time)?;
        let count = hand.waiting();
        self.release();
        self.follow(hand);
        Ok((count, error))
    }

    /// Makes a sensor move the hands.
    pub(crate) fn follow(&mut self, hand: FollowedHand) {
        // An estimator that has seen the elbow of a simulated arm does not trust the fingers of a hand without one.
        self.renew_pipeline();
        self.hand = Hand::Followed(Box::new(hand));
    }

    /// Forgets what was measured of the hands.
    pub(crate) fn renew_pipeline(&mut self) {
        let instance = self.words.instance(&self.layout);
        self.pipeline = new_pipeline(&self.right, &self.left, instance);
    }

    /// Releases everything; the hands rest.
    pub fn release(&mut self) {
        self.lose_hands();
        self.end_recording();
        self.hand = Hand::Resting;
        self.end_live();
    }

    /// Empties the text field.
    pub fn clear_text(&mut self) {
        let typed = self.field.text().chars().count();
        if let Hand::Simulated(person) = &mut self.hand {
            let done = typed.saturating_sub(self.typed_before);
            person.task = rest_of(&person.task, done);
        }
        self.field.clear();
        self.typed_before = 0;
    }

    /// Returns the typed text.
    pub fn text(&self) -> &str {
        self.field.text()
    }

    /// Returns the layout in use.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the state of the hands.
    pub fn hand_state(&self) -> HandState {
        self.hand.state()
    }

    /// Advances the hands by `elapsed`, at most 100 ms. Returns lines: touches and events, the scene, the poses, messages, and the typed
    /// text.
    pub fn advance(&mut self, elapsed: Duration) -> String {
        self.rest = (self.rest + elapsed).min(MAX_ELAPSED);
        let mut readings = Vec::new();
        while self.rest >= PERIOD {
            self.rest -= PERIOD;
            self.time = self.time + PERIOD;
            readings.clear();
            let is_done = self.hand.advance(self.time, &mut readings);
            for message in self.hand.take_messages() {
                self.lines.add_notice(&message);
            }
            if is_done {
                self.hand = Hand::Resting;
                // Once only: a hand that went back there would sweep over keys.
                if self.is_unseen {
                    self.push_idle(&mut readings);
                }
            }
            if readings.is_empty() {
                readings.extend(self.held_reading(self.time));
            }
            self.is_unseen &= readings.is_empty();
            for reading in &readings {
                self.step(reading);
            }
            self.follow_live(&readings);
        }
        self.write_news()
    }

    /// Appends what a sensor measures of the hands at rest.
    fn push_idle(&self, readings: &mut Vec<Reading>) {
        let has_left = self.layout.uses_hand(Side::Left);
        let shown = self.idle.iter().take(1 + usize::from(has_left));
        let reading =
            |(side, sample): &(Side, Sample)| Reading::new(self.time, Some(*side), sample.clone());
        readings.extend(shown.map(reading));
    }

    fn step(&mut self, reading: &Reading) {
        if !matches!(self.hand, Hand::Resting) {
            self.words.keep(reading);
        }
        let mut events = Events::new();
        let is_accepted = self.pipeline.step(reading, &mut events).is_ok();
        let output = self.pipeline.output_for(reading);
        let names = self.pipeline.target_names();
        let view = StepView {
            state: self.pipeline.state(),
            paused_by: self.pipeline.paused_by(),
            profile: 0,
            target_names: names,
            reading: Some(reading),
            source_error: None,
            angles: is_accepted.then_some(&output.estimate.angles),
            pose: is_accepted.then_some(&output.pose),
            touches: if is_accepted { &output.touches } else { &[] },
            presses: &[],
            events: &events,
            commands: &[],
            executed: None,
            lost_hands: self.pipeline.lost_hands(),
            text: self.pipeline.text_state(),
            stats: &Stats::default(),
            latency: None,
        };
        self.scene.follow_keys(&view);
        self.scene.update(&view, &self.pipeline);
        if is_accepted {
            self.poses[output.pose.side.index()] = Some(output.pose);
        }
        for touch in view.touches {
            if touch.phase != Phase::Moved {
                self.lines.add("touches", TouchObject::new(touch, names));
            }
        }
        for event in &events {
            self.field.handle(event);
            self.lines.add("events", EventObject::new(event, names));
        }
    }

    /// Writes the events of a step without a reading, and updates the scene and the text field.
    pub(crate) fn write_events(&mut self, events: &Events) {
        let names = self.pipeline.target_names();
        for event in events {
            self.field.handle(event);
            self.scene.follow_event(event);
            self.lines.add("events", EventObject::new(event, names));
        }
    }

    fn write_news(&mut self) -> String {
        self.scene.write(self.lines.bytes_mut());
        for pose in std::mem::take(&mut self.poses).iter().flatten() {
            write_pose(pose, &mut self.buffer);
            self.lines.add_text("pose", &self.buffer);
        }
        let news = SessionNews {
            hand: self.hand.state(),
            text: self.field.text(),
        };
        self.lines.add("session", news);
        self.write_candidates();
        self.lines.take()
    }

    /// Releases what the hands hold.
    pub(crate) fn lose_hands(&mut self) {
        let mut events = Events::new();
        for side in [Side::Right, Side::Left] {
            self.pipeline.lose(Some(side), None, &mut events);
        }
        self.write_events(&events);
    }
}

/// Returns what is left of a task: a text without its first characters, or the whole script.
fn rest_of(task: &HandTask, typed: usize) -> HandTask {
    match task {
        HandTask::Text {
            text,
            finds_letters,
        } => HandTask::Text {
            text: text.chars().skip(typed).collect(),
            finds_letters: *finds_letters,
        },
        other => other.clone(),
    }
}

/// The entry of a layout in the gallery.
#[derive(Serialize)]
struct Preview<'a> {
    title: &'a str,
    description: &'a str,
    plan: Vec<PlanBoard<'a>>,
}

/// Returns the name, the description and the boards in the plane of a layout that comes with the program, as JSON.
pub fn preview(name: &str) -> Result<String, DocumentError> {
    let layout = Layout::from_document(Document::shipped(name)?)?;
    let preview = Preview {
        title: &layout.name,
        description: &layout.description,
        plan: plan(&layout),
    };
    Ok(serde_json::to_string(&preview).expect("texts and numbers"))
}

/// Returns the layouts that come with the program, as a JSON list of names.
pub fn shipped() -> String {
    let names: Vec<&str> = shipped_layouts().collect();
    serde_json::to_string(&names).expect("names are texts")
}

pub(crate) fn new_pipeline(
    right: &ArmModel,
    left: &ArmModel,
    instance: LayoutInstance,
) -> Pipeline {
    let [own, other] = [(); 2].map(|()| estimator(&JointAngles::default()));
    Pipeline::new(own, right.clone(), instance, pipeline_settings())
        .with_second_hand(other, left.clone())
}

/// Returns the estimator of a hand with this pose at rest; with half-bent fingers if it has none.
pub(crate) fn estimator(rest_pose: &JointAngles) -> Estimator {
    Estimator::new(EstimatorSettings {
        rest_pose: if rest_pose.is_empty() {
            half_bent_fingers()
        } else {
            *rest_pose
        },
        ..EstimatorSettings::default()
    })
}

/// Returns the settings of the pipeline of a page: no delay before output is armed, because nothing that is typed leaves the page.
pub(crate) fn pipeline_settings() -> PipelineSettings {
    PipelineSettings {
        arm_delay: Duration::ZERO,
        stall_timeout: MAX_SILENCE,
        ..PipelineSettings::default()
    }
}
