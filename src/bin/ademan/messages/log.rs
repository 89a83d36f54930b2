//! Log messages of the library: ` WARN cannot …`, at most one per kind and source in 10 s.

use std::fmt::{self, Write};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

use ademan::message::escape_line;
use ademan::message_limits::{HeldBack, MessageLimits};
use tracing::callsite::Identifier;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};
use tracing_subscriber::filter::Targets;

use super::queue::Due;

/// The kind of a message is the line of code that writes it.
type Limits = MessageLimits<(Identifier, String), String>;

static LIMITS: OnceLock<Mutex<Limits>> = OnceLock::new();

/// Prints log messages of these levels from now on.
pub fn install(levels: Targets) {
    tracing::subscriber::set_global_default(Log(levels)).expect("this is called once");
}

/// Returns the messages that were held back for 10 s.
pub fn take_due() -> Due {
    let (mut limits, now) = (limits(), Instant::now());
    let due = std::iter::from_fn(|| limits.take_due(now));
    let due = due.map(|held_back| line(&held_back)).collect();
    (due, limits.next_due())
}

/// Returns all messages that are held back.
pub fn take_all() -> Vec<String> {
    let (mut limits, now) = (limits(), Instant::now());
    let all = std::iter::from_fn(|| limits.take_any(now));
    all.map(|held_back| held_back.to_string()).collect()
}

fn line(held_back: &HeldBack<String>) -> String {
    format!("{}\n", escape_line(&held_back.to_string()))
}

fn limits() -> MutexGuard<'static, Limits> {
    let limits = LIMITS.get_or_init(Mutex::default);
    limits.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A subscriber that prints events of these levels, and ignores spans.
struct Log(Targets);

impl Subscriber for Log {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && self.0.would_enable(metadata.target(), metadata.level())
    }

    fn event(&self, event: &Event<'_>) {
        let mut fields = Fields::default();
        event.record(&mut fields);
        let (metadata, text) = (event.metadata(), &fields.text);
        // The fields of an event are part of its text here, and an event is one line.
        let message = format!("{:>5} {}", metadata.level(), escape_line(text));
        let kind = (metadata.callsite(), fields.source);
        let admitted = limits().admit(kind, 1, message, Instant::now());
        match admitted {
            Some(admitted_message) if *metadata.level() <= Level::WARN => {
                super::print_error(&admitted_message)
            }
            Some(admitted_message) => super::print(&admitted_message),
            None => super::wake(),
        }
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// The message of an event, and its field `source`, which the message names too.
#[derive(Default)]
struct Fields {
    text: String,
    source: String,
}

impl Visit for Fields {
    fn record_str(&mut self, field: &Field, value: &str) {
        match field.name() {
            "source" => value.clone_into(&mut self.source),
            _ => self.record_debug(field, &format_args!("{value}")),
        }
    }

    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        // Writing to a string does not fail.
        let _ = match field.name() {
            "message" => write!(self.text, "{value:?}"),
            name => write!(self.text, " {name}={value:?}"),
        };
    }
}
