//! Invariant I6: states, arming, and touches that begin.

use super::*;

#[test]
fn i6_only_permitted_transitions_occur() {
    let from = |before| {
        let mut pipeline = FakePipeline::running();
        if before == PipelineState::Starting {
            pipeline = FakePipeline::new(PipelineSettings::default());
        }
        pipeline.state = before;
        pipeline.observe(Cause::Other, false, &[]).unwrap();
        pipeline
    };
    let forbidden = [
        (PipelineState::Stopped, PipelineState::Running),
        (PipelineState::Stopped, PipelineState::Paused),
        (PipelineState::Running, PipelineState::Starting),
        (PipelineState::Stalled, PipelineState::Starting),
        (PipelineState::Starting, PipelineState::Stalled),
    ];
    for (before, after) in forbidden {
        let result = from(before).release_all(after, &[]);
        assert_eq!(result, Err(Violation::StateChange(before, after)));
    }
}

#[test]
fn i6_output_is_armed_only_after_the_hand_was_clear_for_the_arming_delay() {
    let after_steps = |steps: usize, touch_at: Option<usize>| {
        let mut pipeline = FakePipeline::new(PipelineSettings::default());
        pipeline.state = PipelineState::Paused;
        for step in 0..steps {
            pipeline.touches.clear();
            if Some(step) == touch_at {
                pipeline.touch(Phase::Touched);
            }
            pipeline.step(&[]).unwrap();
        }
        pipeline.touches.clear();
        pipeline.state = PipelineState::Running;
        pipeline.step(&[])
    };
    assert_eq!(after_steps(30, None), Ok(()));
    assert_eq!(after_steps(29, None), Err(Violation::ArmedTooSoon));
    assert_eq!(after_steps(40, Some(35)), Err(Violation::ArmedTooSoon));
    assert_eq!(after_steps(40, Some(9)), Ok(()));
    assert_eq!(after_steps(40, Some(10)), Err(Violation::ArmedTooSoon));
    let mut pipeline = FakePipeline::new(PipelineSettings::default());
    let unseen = pipeline.release_all(PipelineState::Running, &[]);
    assert_eq!(unseen, Err(Violation::ArmedWithoutReading));
}

#[test]
fn i6_the_step_in_which_the_finger_leaves_begins_the_arming_delay() {
    let mut pipeline = FakePipeline::new(PipelineSettings::default());
    pipeline.state = PipelineState::Paused;
    pipeline.step(&[]).unwrap();
    pipeline.touch(Phase::Touched);
    let touched = pipeline.touches.clone();
    pipeline.touch(Phase::Released);
    let released = pipeline.touches.clone();
    pipeline.touch(Phase::Left);
    let left = pipeline.touches.clone();
    pipeline.touches = [touched, released, left].concat();
    pipeline.step(&[]).unwrap();
    pipeline.touches = Vec::new();
    (0..29).for_each(|_| pipeline.step(&[]).unwrap());
    pipeline.state = PipelineState::Running;
    pipeline.step(&[]).unwrap();
}

#[test]
fn i6_a_stall_restarts_the_arming_delay() {
    let mut pipeline = FakePipeline::running();
    pipeline.release_all(PipelineState::Stalled, &[]).unwrap();
    (0..30).for_each(|_| pipeline.step(&[]).unwrap());
    let mut early = pipeline.fork();
    early.release_all(PipelineState::Stalled, &[]).unwrap();
    early.state = PipelineState::Running;
    assert_eq!(early.step(&[]), Err(Violation::ArmedTooSoon));
    pipeline.state = PipelineState::Running;
    pipeline.step(&[]).unwrap();
}

#[test]
fn i6_a_pause_restarts_the_arming_delay_even_if_the_first_reading_arms() {
    let mut pipeline = FakePipeline::running();
    pipeline.paused_by = Some(CommandOrigin::Layout);
    pipeline.release_all(PipelineState::Paused, &[]).unwrap();
    (0..50).for_each(|_| pipeline.step(&[]).unwrap());
    (pipeline.state, pipeline.paused_by) = (PipelineState::Running, None);
    assert_eq!(pipeline.step(&[]), Err(Violation::ArmedTooSoon));
}

#[test]
fn i6_a_requested_pause_is_kept() {
    let mut pipeline = FakePipeline::running();
    pipeline.paused_by = Some(CommandOrigin::Client);
    let result = pipeline.release_all(PipelineState::Stalled, &[]);
    assert_eq!(result, Err(Violation::PauseNotKept(PipelineState::Stalled)));
}

#[test]
fn i6_a_hand_ends_only_a_pause_of_the_layout() {
    for &origin in CommandOrigin::ALL {
        let mut pipeline = FakePipeline::running();
        pipeline.paused_by = Some(origin);
        pipeline.release_all(PipelineState::Paused, &[]).unwrap();
        pipeline.step(&[]).unwrap();
        pipeline.paused_by = None;
        let expected = match origin {
            CommandOrigin::Layout => Ok(()),
            _ => Err(Violation::PauseEndedByHand(origin)),
        };
        assert_eq!(pipeline.fork().step(&[]), expected);
        assert_eq!(pipeline.observe(Cause::Other, false, &[]), Ok(()));
    }
}

#[test]
fn i6_no_events_occur_after_the_end_or_while_not_running() {
    let result = |state| {
        let mut pipeline = FakePipeline::running();
        pipeline.release_all(state, &[]).unwrap();
        pipeline.release_all(state, &[EventKind::Value(TargetId(0), 0.5)])
    };
    let value = EventKind::Value(TargetId(0), 0.5);
    assert_eq!(
        result(PipelineState::Stopped),
        Err(Violation::EventAfterStop(value))
    );
    assert_eq!(
        result(PipelineState::Paused),
        Err(Violation::EventWhileNotRunning(value))
    );
}

#[test]
fn i6_a_touch_begins_after_a_step_with_the_finger_clear() {
    let mut pipeline = FakePipeline::running();
    pipeline.touch(Phase::Touched);
    pipeline.step(&[]).unwrap();
    pipeline.touch(Phase::Moved);
    pipeline.step(&[]).unwrap();
    let mut goes_on = pipeline.fork();
    goes_on.release_all(PipelineState::Running, &[]).unwrap();
    let never = Violation::TouchNeverBegan(Finger::Index, Side::Right, TargetId(3));
    assert_eq!(goes_on.step(&[]), Err(never));

    for state in [
        PipelineState::Running,
        PipelineState::Stalled,
        PipelineState::Paused,
    ] {
        let mut pipeline = pipeline.fork();
        pipeline.release_all(state, &[]).unwrap();
        pipeline.touch(Phase::Touched);
        assert_eq!(pipeline.fork().step(&[]), Err(FIRST_STEP));
        pipeline.touches.clear();
        pipeline.step(&[]).unwrap();
        pipeline.touch(Phase::Touched);
        pipeline.step(&[]).unwrap();
    }
    pipeline.state = PipelineState::Stalled;
    assert_eq!(pipeline.step(&[]), Err(never), "a reading that is too late");
}

#[test]
fn i6_the_touch_that_ends_a_pause_ends_with_the_pause() {
    let mut pipeline = FakePipeline::running();
    pipeline.release_all(PipelineState::Stalled, &[]).unwrap();
    pipeline.paused_by = Some(CommandOrigin::Layout);
    pipeline.release_all(PipelineState::Paused, &[]).unwrap();
    pipeline.step(&[]).unwrap();
    pipeline.touch(Phase::Touched);
    (pipeline.state, pipeline.paused_by) = (PipelineState::Stalled, None);
    pipeline.step(&[]).unwrap();
    assert_eq!(pipeline.fork().step(&[]), Err(FIRST_STEP));
    pipeline.touch(Phase::Moved);
    let never = Violation::TouchNeverBegan(Finger::Index, Side::Right, TargetId(3));
    assert_eq!(pipeline.step(&[]), Err(never));
}
