//! The sixth invariant: states, arming, and touches that begin.

use super::*;

#[test]
fn i6_only_changes_of_state_that_there_are() {
    let from = |before| {
        let mut engine = Engine::running();
        if before == PipelineState::Starting {
            engine = Engine::new(PipelineSettings::default());
        }
        engine.state = before;
        engine.see(Cause::Other, false, &[]).unwrap();
        engine
    };
    let forbidden = [
        (PipelineState::Stopped, PipelineState::Running),
        (PipelineState::Stopped, PipelineState::Paused),
        (PipelineState::Running, PipelineState::Starting),
        (PipelineState::Stalled, PipelineState::Starting),
        (PipelineState::Starting, PipelineState::Stalled),
    ];
    for (before, after) in forbidden {
        let told = from(before).let_go(after, &[]);
        assert_eq!(told, Err(Violation::StateChange(before, after)));
    }
}

#[test]
fn i6_it_runs_only_by_a_hand_that_was_off_for_long_enough() {
    let calm = |frames: usize, touched_at: Option<usize>| {
        let mut engine = Engine::new(PipelineSettings::default());
        engine.state = PipelineState::Paused;
        for frame in 0..frames {
            engine.touches.clear();
            if Some(frame) == touched_at {
                engine.touch(Phase::Touched);
            }
            engine.frame(&[]).unwrap();
        }
        engine.touches.clear();
        engine.state = PipelineState::Running;
        engine.frame(&[])
    };
    assert_eq!(calm(30, None), Ok(()));
    assert_eq!(calm(29, None), Err(Violation::ArmedTooSoon));
    assert_eq!(calm(40, Some(35)), Err(Violation::ArmedTooSoon));
    assert_eq!(calm(40, Some(9)), Ok(()));
    assert_eq!(calm(40, Some(10)), Err(Violation::ArmedTooSoon));
    let mut engine = Engine::new(PipelineSettings::default());
    let unseen = engine.let_go(PipelineState::Running, &[]);
    assert_eq!(unseen, Err(Violation::ArmedWithoutReading));
}

#[test]
fn i6_a_frame_in_which_the_finger_leaves_is_the_first_that_shows_it_off() {
    let mut engine = Engine::new(PipelineSettings::default());
    engine.state = PipelineState::Paused;
    engine.frame(&[]).unwrap();
    engine.touch(Phase::Touched);
    let touched = engine.touches.clone();
    engine.touch(Phase::Released);
    let released = engine.touches.clone();
    engine.touch(Phase::Left);
    let left = engine.touches.clone();
    engine.touches = [touched, released, left].concat();
    engine.frame(&[]).unwrap();
    engine.touches = Vec::new();
    (0..29).for_each(|_| engine.frame(&[]).unwrap());
    engine.state = PipelineState::Running;
    engine.frame(&[]).unwrap();
}

#[test]
fn i6_after_a_stall_the_time_counts_anew() {
    let mut engine = Engine::running();
    engine.let_go(PipelineState::Stalled, &[]).unwrap();
    (0..30).for_each(|_| engine.frame(&[]).unwrap());
    let mut early = engine.clone_oracle();
    early.let_go(PipelineState::Stalled, &[]).unwrap();
    early.state = PipelineState::Running;
    assert_eq!(early.frame(&[]), Err(Violation::ArmedTooSoon));
    engine.state = PipelineState::Running;
    engine.frame(&[]).unwrap();
}

#[test]
fn i6_after_a_pause_the_time_counts_anew_also_where_the_first_reading_arms() {
    let mut engine = Engine::running();
    engine.is_paused = true;
    engine.let_go(PipelineState::Paused, &[]).unwrap();
    (0..50).for_each(|_| engine.frame(&[]).unwrap());
    (engine.state, engine.is_paused) = (PipelineState::Running, false);
    assert_eq!(engine.frame(&[]), Err(Violation::ArmedTooSoon));
}

#[test]
fn i6_a_pause_stays_one() {
    let mut engine = Engine::running();
    engine.is_paused = true;
    let told = engine.let_go(PipelineState::Stalled, &[]);
    assert_eq!(told, Err(Violation::PauseNotKept(PipelineState::Stalled)));
}

#[test]
fn i6_nothing_goes_out_after_the_end_or_while_nothing_may() {
    let told = |state| {
        let mut engine = Engine::running();
        engine.let_go(state, &[]).unwrap();
        engine.let_go(state, &[EventKind::Value(TargetId(0), 0.5)])
    };
    let value = EventKind::Value(TargetId(0), 0.5);
    assert_eq!(
        told(PipelineState::Stopped),
        Err(Violation::EventAfterStop(value))
    );
    assert_eq!(
        told(PipelineState::Paused),
        Err(Violation::EventWhileNotRunning(value))
    );
}

#[test]
fn i6_a_touch_begins_after_a_frame_that_showed_the_finger_off() {
    let mut engine = Engine::running();
    engine.touch(Phase::Touched);
    engine.frame(&[]).unwrap();
    engine.touch(Phase::Moved);
    engine.frame(&[]).unwrap();
    let mut goes_on = engine.clone_oracle();
    goes_on.let_go(PipelineState::Running, &[]).unwrap();
    let never = Violation::TouchNeverBegan(Finger::Index, Side::Right, TargetId(3));
    assert_eq!(goes_on.frame(&[]), Err(never));

    for state in [
        PipelineState::Running,
        PipelineState::Stalled,
        PipelineState::Paused,
    ] {
        let mut engine = engine.clone_oracle();
        engine.let_go(state, &[]).unwrap();
        engine.touch(Phase::Touched);
        assert_eq!(engine.clone_oracle().frame(&[]), Err(NOT_SEEN));
        engine.touches.clear();
        engine.frame(&[]).unwrap();
        engine.touch(Phase::Touched);
        engine.frame(&[]).unwrap();
    }
    engine.state = PipelineState::Stalled;
    assert_eq!(engine.frame(&[]), Err(never), "a reading that is too late");
}

#[test]
fn i6_the_touch_that_ends_a_pause_ends_with_it() {
    let mut engine = Engine::running();
    engine.let_go(PipelineState::Stalled, &[]).unwrap();
    engine.is_paused = true;
    engine.let_go(PipelineState::Paused, &[]).unwrap();
    engine.frame(&[]).unwrap();
    engine.touch(Phase::Touched);
    (engine.state, engine.is_paused) = (PipelineState::Stalled, false);
    engine.frame(&[]).unwrap();
    assert_eq!(engine.clone_oracle().frame(&[]), Err(NOT_SEEN));
    engine.touch(Phase::Moved);
    let never = Violation::TouchNeverBegan(Finger::Index, Side::Right, TargetId(3));
    assert_eq!(engine.frame(&[]), Err(never));
}
