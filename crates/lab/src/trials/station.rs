//! One person in front of a layout.

use crate::contact::TargetId;
use crate::document::{Document, DocumentError};
use crate::estimate::{ChannelMap, Estimator, EstimatorSettings, LANDMARK_SMOOTHING};
use crate::hand::Side;
use crate::kinematics::{ArmModel, ArmModelError, half_bent_fingers};
use crate::layout::{Fit, Glove, Layout};
use crate::people::Participant;
use crate::pipeline::{LayoutInstance, Pipeline, PipelineSettings, PressFilter};
use crate::readings::{DecoderFactory, Recorder, SharedRecorder};
use crate::sim::TypingKeys;
use crate::sim::fluent::{FluentHand, HandSetup, SourceKind, StartPosture};

/// The gloves of the program, right and left.
const GLOVES: [&str; 2] = ["unam-hc11", "unam-hc11-left"];

/// Reason why a person cannot be put in front of a layout.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The layout or a glove cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The bones make no arm.
    #[error("cannot make the arm of a simulated person: {0}")]
    Arm(#[from] ArmModelError),
    /// A decoder has nothing to decode.
    #[error("a text decoder needs a layout for a US keymap with at least ten keys of letters")]
    NoLetters,
}

/// A person in front of a layout that fits what the pipeline assumes of the person.
pub struct Station {
    pub(super) person: Participant,
    pub(super) layout: Layout,
    pub(super) hands: Vec<FluentHand>,
    pub(super) source: SourceKind,
    assumed: Vec<ArmModel>,
    maps: Vec<Option<ChannelMap>>,
    /// The decoder of the person, and what the devices type before it.
    pub(super) recorder: Option<SharedRecorder>,
    finds_letters: bool,
}

impl Station {
    /// Creates the station of a person at a layout.
    pub fn new(
        document: &Document,
        person: &Participant,
        source: SourceKind,
    ) -> Result<Self, TrialError> {
        let design = Layout::from_document(document.clone())?;
        let sides = sides(&design, person);
        let arms = |bones: crate::kinematics::BoneLengths| {
            let arms = sides.iter();
            arms.map(|&side| ArmModel::anthropometric(side, &bones))
                .collect::<Result<Vec<_>, _>>()
        };
        let (assumed, own) = (arms(person.assumed)?, arms(person.own)?);
        let fit = Fit::new(&assumed[0], assumed.get(1))?;
        let layout = Layout::for_hands(document.clone(), fit)?;
        let map = |&side: &Side| -> Result<Option<ChannelMap>, DocumentError> {
            if !source.is_glove() {
                return Ok(None);
            }
            let name = GLOVES[usize::from(side == Side::Left)];
            let glove = Glove::parse(&Document::shipped(name)?)?;
            Ok(Some(source.channel_map(glove.map, person)))
        };
        let maps = sides.iter().map(map).collect::<Result<Vec<_>, _>>()?;
        let keys = TypingKeys::new(&layout);
        let posture = match (
            layout.scene.has_bend_targets(),
            layout.scene.starts_at_hand(),
        ) {
            (true, _) => StartPosture::Straight,
            (_, true) => StartPosture::Open,
            _ => StartPosture::Relaxed,
        };
        let all = assumed.iter().zip(&own).zip(&maps);
        let hands = all.map(|((assumed_arm, own_arm), channel_map)| {
            let setup = HandSetup {
                assumed: assumed_arm,
                own: own_arm,
                map: channel_map.as_ref(),
                source,
            };
            FluentHand::new(setup, person, &keys, posture)
        });
        Ok(Self {
            hands: hands.collect(),
            person: person.clone(),
            layout,
            source,
            assumed,
            maps,
            recorder: None,
            finds_letters: false,
        })
    }

    /// Adds a text decoder after the devices. Returns `false` if the layout has too few letters for it.
    pub fn set_decoder(&mut self, decoder: &DecoderFactory) -> bool {
        let decoder = decoder(&self.layout, self.hands.len() > 1);
        self.finds_letters = decoder.as_deref().is_some_and(PressFilter::finds_letters);
        let recorder = decoder.map(|decoder| Recorder::new(&self.layout, decoder));
        self.recorder = recorder.map(SharedRecorder::new);
        self.recorder.is_some()
    }

    /// Returns `true` if the decoder finds the letters of multitap keys from one tap each.
    pub(crate) fn finds_letters(&self) -> bool {
        self.finds_letters
    }

    /// Returns the layout, as it fits the person.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the person.
    pub fn person(&self) -> &Participant {
        &self.person
    }

    /// Returns the arms that the pipeline assumes, the right one first of two.
    pub fn assumed_arms(&self) -> &[ArmModel] {
        &self.assumed
    }

    /// Returns the arms that the pipeline assumes with the channels of their gloves: people who do tasks have adapted to the hand that
    /// they are shown.
    pub(super) fn arms(&self) -> impl Iterator<Item = (&ArmModel, Option<&ChannelMap>)> {
        let maps = self.maps.iter().map(Option::as_ref);
        self.assumed.iter().zip(maps)
    }

    /// Returns a pipeline that has seen nothing.
    pub(super) fn pipeline(&self) -> Pipeline {
        let settings = EstimatorSettings {
            position_smoothing: (self.source == SourceKind::Camera).then_some(LANDMARK_SMOOTHING),
            rest_pose: half_bent_fingers(),
            ..EstimatorSettings::default()
        };
        let estimator = |index: usize| {
            let estimator = Estimator::new(settings);
            match &self.maps[index] {
                Some(map) => estimator.with_channels(map),
                None => estimator,
            }
        };
        let layout = LayoutInstance::from_layout(&self.layout);
        let arms = &self.assumed;
        let pipeline = Pipeline::new(
            estimator(0),
            arms[0].clone(),
            layout,
            PipelineSettings::default(),
        );
        let pipeline = match &self.recorder {
            Some(recorder) => pipeline.with_filter(Box::new(recorder.clone())),
            None => pipeline,
        };
        match arms.get(1) {
            Some(arm) => pipeline.with_second_hand(estimator(1), arm.clone()),
            None => pipeline,
        }
    }

    /// Returns the targets on boards that no finger of the person reaches.
    pub fn out_of_reach(&mut self) -> Vec<TargetId> {
        let boards = self.layout.boards.iter();
        let faces = boards.flat_map(|board| self.layout.faces(board));
        let targets: Vec<TargetId> = faces.map(|face| face.target).collect();
        let is_missed = |target: &TargetId| {
            let Some(hand) = self.hand_for(*target) else {
                return true;
            };
            let finger = self.hands[hand].finger_for(&self.layout.scene, *target);
            finger.is_none()
        };
        targets.into_iter().filter(is_missed).collect()
    }

    /// Returns the index of the hand for a target.
    pub(super) fn hand_for(&self, target: TargetId) -> Option<usize> {
        let (surface, _) = self.layout.scene.target(target)?;
        match surface.side() {
            Some(side) => self.hands.iter().position(|hand| hand.side() == side),
            None => Some(0),
        }
    }
}

/// Returns the sides of the hands in use: both if the layout has boards for both.
fn sides(layout: &Layout, person: &Participant) -> Vec<Side> {
    let has = |side| layout.has_board_for(side);
    match (has(Side::Right), has(Side::Left)) {
        (true, true) if !person.one_hand => vec![Side::Right, Side::Left],
        (false, true) => vec![Side::Left],
        _ => vec![Side::Right],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Events;
    use crate::people::{People, population};
    use crate::pipeline::press_filter::FilterInput;

    /// A decoder that finds letters, and changes nothing.
    struct Finder;

    impl PressFilter for Finder {
        fn filter(&mut self, _: &FilterInput, _: &mut Events) {}

        fn reset(&mut self) {}

        fn finds_letters(&self) -> bool {
            true
        }
    }

    #[test]
    fn letters_of_multitap_keys_are_typed_where_a_decoder_finds_them() {
        let document = Document::shipped("phone-words").expect("a shipped layout");
        let person = population(&People::Drawn(1), None, 2).remove(0);
        let mut station = Station::new(&document, &person, SourceKind::Ideal).expect("a station");
        let phrase = "a cab, 2";
        assert!(!station.strokes_for([phrase]).can_type());
        let make = |_: &Layout, _: bool| -> Option<Box<dyn PressFilter>> { Some(Box::new(Finder)) };
        assert!(station.set_decoder(&make));
        assert_eq!(station.strokes_for([phrase]).typable(phrase), "a cab ");
    }
}
