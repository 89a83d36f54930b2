//! Views of a recording that is played as fast as possible: a view is published when it is due by the time of the readings.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::time::Instant;

use crossbeam_channel::Receiver;

use super::View;
use super::publisher::{Published, SessionNames, ViewPublisher};
use crate::session::latest::LatestSender;
use crate::session::observer::Observer;
use ademan_core::layout::Layout;
use ademan_core::pipeline::Pipeline;
use ademan_core::snapshot::StepView;
use ademan_core::time::Timestamp;

/// The publisher of the views of a replay, and their receiver.
pub(in crate::session) struct ReplayViews {
    publisher: ViewPublisher,
    published: Receiver<Published>,
    /// The instant of the time stamp 0.
    start: Instant,
}

impl ReplayViews {
    pub fn new(names: SessionNames, layout: Arc<Layout>) -> Self {
        let (sender, published) = LatestSender::new();
        // The replay is the only viewer.
        let viewers = Arc::new(AtomicUsize::new(1));
        Self {
            publisher: ViewPublisher::new(sender, viewers, names, layout),
            published,
            start: Instant::now(),
        }
    }

    /// Returns the view after a step, if one is due.
    pub fn update(&mut self, step: &StepView, pipeline: &Pipeline) -> Option<View> {
        let elapsed = pipeline.time().since(Timestamp::default());
        let now = self.start.checked_add(elapsed).unwrap_or(self.start);
        self.publisher.observe(step, now, pipeline);
        // The steps of a replay have the poses, and Studio keeps many views: they have no hands.
        let published = self.published.try_recv().ok()?;
        Some(View {
            layout: published.layout,
            boards: published.boards,
            state: Arc::new(published.state),
            messages: Arc::default(),
            missed: 0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Hc11Format, Source, SourceEvent};
    use crate::setup::{LoadedSetup, ProfileSetup, Setup};
    use ademan_core::contact::TargetId;
    use ademan_core::device::{EventKind, Events, OutputEvent};
    use ademan_core::pipeline::PipelineState;
    use ademan_core::snapshot::Snapshot;

    fn views_of(setup: &LoadedSetup) -> ReplayViews {
        let names = SessionNames {
            session: String::new(),
            process: None,
            profiles: setup.profile_names().map(str::to_owned).collect(),
            source: String::new(),
            output: String::new(),
        };
        ReplayViews::new(names, Arc::new(setup.layout.clone()))
    }

    #[test]
    fn a_value_that_a_layout_resets_when_another_one_follows_is_not_shown_as_one_of_that() {
        let profile = ProfileSetup {
            name: "numbers".into(),
            layout: "numpad".into(),
            text: None,
        };
        let setup = Setup {
            profiles: vec![profile],
            ..Setup::default()
        };
        let loaded = setup.load_files().unwrap();
        let mut views = views_of(&loaded);
        let mut pipeline = loaded.pipeline();
        let emitted = |value| Snapshot {
            events: Events::from_iter([OutputEvent {
                time: Timestamp::default(),
                kind: EventKind::Value(TargetId(3), value),
            }]),
            ..Snapshot::default()
        };
        views.update(&Snapshot::default().view(), &pipeline);
        views.update(&emitted(1.0).view(), &pipeline);
        pipeline.switch_profile(1, &mut Events::new());
        let view = views.update(&emitted(0.0).view(), &pipeline);
        let state = view.expect("a view of the next layout").state;
        assert_eq!(state.profile, "numbers");
        assert!(state.values.is_empty(), "{:?}", state.values);
    }

    #[test]
    fn a_source_that_has_stopped_has_no_readings_per_second() {
        let loaded = Setup::default().load_files().unwrap();
        let mut views = views_of(&loaded);
        let mut pipeline = loaded.pipeline();
        let typist = loaded.typist("hello", &Hc11Format::default(), 0.0, 0);
        let mut typist = typist.unwrap();
        let mut snapshot = Snapshot::default();
        let mut rate = 0.0;
        while let Ok(SourceEvent::Reading(reading)) = typist.next() {
            pipeline.step(&reading, &mut Events::new()).unwrap();
            snapshot.stats.source.readings += 1;
            snapshot.reading = Some(reading);
            if let Some(view) = views.update(&snapshot.view(), &pipeline) {
                rate = view.state.readings_per_second;
            }
        }
        assert!(rate > 10.0, "{rate} readings per second");
        pipeline.stall(&mut Events::new());
        snapshot.reading = None;
        snapshot.state = PipelineState::Stalled;
        let view = views.update(&snapshot.view(), &pipeline);
        let state = view.expect("a view of the stall").state;
        assert_eq!(state.readings_per_second, 0.0);
    }
}
