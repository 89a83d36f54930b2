//! Notifications of a session, and a queue for each client that has subscribed.
//!
//! The session loop never waits: it drops notifications if the queue is full. A thread of the server converts them to
//! lines. A client that does not read its lines loses the oldest ones.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Instant;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::response::{self, JsonLine};
use crate::session::observer::Observer;
use crate::session::reload::LayoutReport;
use ademan_core::command::CommandOrigin;
use ademan_core::contact::{Presses, TargetNames};
use ademan_core::device::{CursorPosition, Events, TimedCommands};
use ademan_core::pipeline::{LayoutInstance, Pipeline, PipelineState};
use ademan_core::snapshot::StepView;

/// Capacity of the queue from the session loop to the thread that converts notifications.
const QUEUE_NOTIFICATIONS: usize = 64;

/// Capacity of the queue of each client.
const QUEUE_LINES: usize = 64;

// A box would be an allocation in the session loop.
#[allow(clippy::large_enum_variant)]
enum Notification {
    Commands(TimedCommands),
    Presses(Presses, TargetNames),
    Events(Events, TargetNames),
    Cursor(CursorPosition),
    State {
        state: PipelineState,
        paused_by: Option<CommandOrigin>,
    },
    Reload {
        is_active: bool,
        text: String,
    },
}

/// The sender of notifications, for the session loop.
#[derive(Clone)]
pub struct Notifier {
    sender: Sender<Notification>,
    subscribers: Subscribers,
    last: Option<(PipelineState, Option<CommandOrigin>)>,
    cursor: Option<CursorPosition>,
}

impl Notifier {
    /// Creates a notifier without subscribers, and the queue for [`broadcast`].
    pub(super) fn new() -> (Self, NotificationQueue) {
        let (sender, receiver) = bounded(QUEUE_NOTIFICATIONS);
        let subscribers = Subscribers::default();
        let notifier = Self {
            sender,
            subscribers: subscribers.clone(),
            last: None,
            cursor: None,
        };
        let queue = NotificationQueue {
            receiver,
            subscribers,
        };
        (notifier, queue)
    }

    /// Notifies the subscribers of the commands, presses and events of a step and of a new state. Does not wait, and does nothing
    /// without subscribers.
    pub fn notify_step(&mut self, step: &StepView) {
        let (state, paused_by) = (step.state, step.paused_by);
        let is_new = self.last.replace((state, paused_by)) != Some((state, paused_by));
        if self.subscribers.count.load(Ordering::Relaxed) == 0 {
            return;
        }
        if !step.commands.is_empty() {
            self.send(Notification::Commands(
                step.commands.iter().copied().collect(),
            ));
        }
        if !step.presses.is_empty() {
            let names = step.target_names.clone();
            let presses = step.presses.iter().cloned().collect();
            self.send(Notification::Presses(presses, names));
        }
        if !step.events.is_empty() {
            let names = step.target_names.clone();
            let events = step.events.iter().copied().collect();
            self.send(Notification::Events(events, names));
        }
        if is_new {
            self.send(Notification::State { state, paused_by });
        }
    }

    /// Notifies the subscribers of a new position of the cursor of the active layout. Does not wait, and does nothing
    /// without subscribers.
    pub fn notify_cursor(&mut self, layout: &LayoutInstance) {
        if self.subscribers.count.load(Ordering::Relaxed) == 0 {
            return;
        }
        let cursor = layout.cursor();
        if self.cursor != cursor {
            self.cursor.clone_from(&cursor);
            self.send(Notification::Cursor(cursor.unwrap_or_default()));
        }
    }

    /// Notifies the subscribers of the outcome of a change to a layout. Does not wait.
    pub fn notify_reload(&mut self, report: &LayoutReport) {
        self.send(Notification::Reload {
            is_active: matches!(
                report,
                LayoutReport::Activated(_) | LayoutReport::ValidAgain(_)
            ),
            text: report.to_string(),
        });
    }

    fn send(&self, notification: Notification) {
        let lines = match &notification {
            Notification::Commands(commands) => commands.len() as u64,
            Notification::Presses(presses, _) => presses.len() as u64,
            Notification::Events(events, _) => events.len() as u64,
            Notification::Cursor(_) | Notification::State { .. } | Notification::Reload { .. } => 1,
        };
        if self.sender.try_send(notification).is_err() {
            self.subscribers.missed.fetch_add(lines, Ordering::Relaxed);
        }
    }
}

impl Observer for Notifier {
    fn observe(&mut self, step: &StepView, _: Instant, pipeline: &Pipeline) {
        self.notify_step(step);
        self.notify_cursor(pipeline.layout());
    }
}

/// The receiver of notifications, for the server.
pub(super) struct NotificationQueue {
    receiver: Receiver<Notification>,
    pub subscribers: Subscribers,
}

/// Converts notifications to lines for all subscribers until all notifiers are dropped.
pub(super) fn broadcast(queue: &NotificationQueue) {
    let mut buffer = Vec::new();
    let subscribers = &queue.subscribers;
    for notification in &queue.receiver {
        let missed = subscribers.missed.swap(0, Ordering::Relaxed);
        if missed > 0 {
            subscribers.add_missed(missed);
        }
        match notification {
            Notification::Commands(commands) => {
                for issued in &commands {
                    subscribers.push(&response::command_notification(issued, &mut buffer));
                }
            }
            Notification::Presses(presses, names) => {
                for press in &presses {
                    subscribers.push(&response::press_notification(press, &names));
                }
            }
            Notification::Events(events, names) => {
                for event in &events {
                    subscribers.push(&response::event_notification(event, &names, &mut buffer));
                }
            }
            Notification::Cursor(cursor) => {
                subscribers.push(&response::cursor_notification(&cursor));
            }
            Notification::State { state, paused_by } => {
                subscribers.push(&response::state_notification(state, paused_by));
            }
            Notification::Reload { is_active, text } => {
                subscribers.push(&response::reload_notification(is_active, &text));
            }
        }
    }
}

/// The queues of all clients that have subscribed.
#[derive(Clone, Default)]
pub(super) struct Subscribers {
    /// Number of queues, for the session loop, which must not wait for the lock.
    count: Arc<AtomicUsize>,
    /// Lines that the session loop could not send.
    missed: Arc<AtomicU64>,
    queues: Arc<Mutex<Vec<SubscriberQueue>>>,
}

impl Subscribers {
    /// Adds a queue, which is filled until the subscription is dropped.
    pub fn add(&self) -> Subscription {
        let (sender, lines) = bounded(QUEUE_LINES);
        let missed = Arc::new(AtomicU64::new(0));
        let subscription = Subscription {
            lines: lines.clone(),
            missed: missed.clone(),
        };
        let queue = SubscriberQueue {
            sender,
            oldest: lines,
            missed: Arc::downgrade(&missed),
        };
        self.with_queues(|queues| queues.push(queue));
        subscription
    }

    fn push(&self, line: &JsonLine) {
        self.with_queues(|queues| queues.retain(|queue| queue.push(line)));
    }

    fn add_missed(&self, count: u64) {
        self.with_queues(|queues| {
            for queue in queues {
                queue.add_missed(count);
            }
        });
    }

    fn with_queues(&self, change: impl FnOnce(&mut Vec<SubscriberQueue>)) {
        let mut queues = self.queues.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut queues);
        self.count.store(queues.len(), Ordering::Relaxed);
    }
}

/// The sending end of the queue of a client.
struct SubscriberQueue {
    sender: Sender<JsonLine>,
    /// Receiver that drops the oldest line when the queue is full.
    oldest: Receiver<JsonLine>,
    missed: Weak<AtomicU64>,
}

impl SubscriberQueue {
    /// Adds a line, and drops the oldest one if the queue is full. Returns `true` if the subscription still exists.
    fn push(&self, line: &JsonLine) -> bool {
        let mut line = line.clone();
        while let Err(TrySendError::Full(unsent)) = self.sender.try_send(line) {
            line = unsent;
            if self.oldest.try_recv().is_ok() {
                self.add_missed(1);
            }
        }
        self.missed.strong_count() > 0
    }

    fn add_missed(&self, count: u64) {
        if let Some(missed) = self.missed.upgrade() {
            missed.fetch_add(count, Ordering::Relaxed);
        }
    }
}

/// The receiving end of the queue of a client.
pub(super) struct Subscription {
    /// Lines in order of time.
    pub lines: Receiver<JsonLine>,
    missed: Arc<AtomicU64>,
}

impl Subscription {
    /// Returns the number of lines that were dropped since the last call.
    pub fn take_missed(&self) -> u64 {
        self.missed.swap(0, Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::command::Command;
    use ademan_core::contact::{Neighbor, Press, TargetId};
    use ademan_core::device::{EventKind, OutputEvent, TimedCommand};
    use ademan_core::hand::{Finger, Side};
    use ademan_core::snapshot::Snapshot;
    use ademan_core::time::Timestamp;
    use parry3d::math::Vec3;

    #[test]
    fn subscribers_receive_the_commands_of_a_step_before_its_presses_and_its_events() {
        let time = Timestamp(12_400);
        let issued = |command| TimedCommand { time, command };
        let nudge = Command::Nudge {
            x_mm: 0.0,
            y_mm: -1.5,
            z_mm: 2.0,
        };
        let press = Press {
            time,
            side: Side::Left,
            finger: Finger::Index,
            target: TargetId(7),
            point: Vec3::new(0.5, -0.25, -0.125),
            depth: 0.125,
            speed: 0.5,
            neighbors: [Neighbor {
                target: TargetId(8),
                distance: 0.25,
            }]
            .into_iter()
            .collect(),
        };
        let step = Snapshot {
            state: PipelineState::Paused,
            paused_by: Some(CommandOrigin::Client),
            presses: Presses::from_iter([press]),
            events: Events::from_iter([OutputEvent {
                time,
                kind: EventKind::KeyUp("Q".parse().unwrap()),
            }]),
            commands: TimedCommands::from_iter([issued(nudge), issued(Command::TogglePause)]),
            ..Snapshot::default()
        };
        let (mut notifier, queue) = Notifier::new();
        let subscription = queue.subscribers.add();
        notifier.notify_step(&step.view());
        drop(notifier);
        broadcast(&queue);
        let lines: Vec<_> = subscription.lines.try_iter().collect();
        let lines: Vec<&str> = lines.iter().map(|line| &**line).collect();
        let expected = [
            r#"{"time_us":12400,"command":"nudge","x_mm":0.0,"y_mm":-1.5,"z_mm":2.0}"#,
            r#"{"time_us":12400,"command":"toggle-pause"}"#,
            r#"{"event":"press","time_us":12400,"side":"left","finger":"index","target":7,"point_mm":[500.0,-250.0,-125.0],"depth_mm":125.0,"speed_mm_s":500.0,"neighbors":[{"target":8,"distance_mm":250.0}]}"#,
            r#"{"time_us":12400,"event":"key-up","key":"Q"}"#,
            r#"{"event":"state","state":"paused","paused":true,"paused_by":"command"}"#,
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn a_full_queue_drops_the_oldest_lines_and_counts_them() {
        let subscribers = Subscribers::default();
        let subscription = subscribers.add();
        for line in 0..QUEUE_LINES + 3 {
            subscribers.push(&line.to_string().into());
        }
        assert_eq!(subscription.take_missed(), 3);
        assert_eq!(subscription.take_missed(), 0);
        let lines: Vec<_> = subscription.lines.try_iter().collect();
        assert_eq!(lines.len(), QUEUE_LINES);
        assert_eq!(&*lines[0], "3");
    }

    #[test]
    fn the_queue_of_a_closed_connection_is_removed_with_the_next_line() {
        let subscribers = Subscribers::default();
        let open = subscribers.add();
        drop(subscribers.add());
        subscribers.push(&"a".into());
        assert_eq!(subscribers.count.load(Ordering::Relaxed), 1);
        assert_eq!(open.lines.len(), 1);
    }

    #[test]
    fn notifications_that_the_loop_drops_are_counted() {
        let (mut notifier, queue) = Notifier::new();
        let subscription = queue.subscribers.add();
        for _ in 0..QUEUE_NOTIFICATIONS + 2 {
            notifier.notify_reload(&LayoutReport::Rejected("no".into()));
        }
        drop(notifier);
        broadcast(&queue);
        assert_eq!(subscription.take_missed(), 2);
        let line = subscription.lines.try_recv().unwrap();
        assert_eq!(&*line, r#"{"event":"reload","active":false,"text":"no"}"#);
    }
}
