//! The setup of a session beside another one, without the devices of that.

use ademan_core::layout::Layout;
use ademan_core::pipeline::{PipelineSettings, SourcePermissions};

use super::{LoadedSetup, OtherHand, Setup};
use crate::capture::Haptics;
use crate::sim::LayoutFeed;

impl LoadedSetup {
    /// Returns the setup of a session for the same hands on one layout, whose source gives positions of joints. It uses no device of
    /// this setup, has no output, and writes no file. Output is armed by the first reading.
    #[must_use]
    pub fn without_devices(&self, layout: &Layout) -> Self {
        let setup = Setup {
            source: None,
            role: None,
            arm_source: None,
            arm_role: None,
            glove: None,
            other_hand: self.setup.other_hand.as_ref().map(|_| OtherHand::default()),
            output: "none".into(),
            share: Vec::new(),
            haptics: Haptics::Off,
            learn_ranges: false,
            arm_immediately: true,
            panic_keys: Vec::new(),
            profiles_by_application: Vec::new(),
            ..self.setup.clone()
        };
        let mut own = self.clone();
        own.setup = setup;
        own.glove = None;
        if let Some(hand) = &mut own.other_hand {
            hand.glove = None;
        }
        own.layout = layout.clone();
        own.has_files = false;
        own.pipeline = PipelineSettings {
            arm_immediately: true,
            permissions: SourcePermissions::LOCAL,
            ..self.pipeline
        };
        own.layout_feed = LayoutFeed::default();
        own
    }
}
