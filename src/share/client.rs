//! A client of a server.

use std::sync::Arc;

use serde_json::json;

use super::conversation::Conversation;
use super::frame::text_frame;
use super::kinds::{KindSet, LineKind};
use super::lines::{Line, LineEncoder, Wanted};
use super::listener::Connection;
use super::outbox::{Chunk, Outbox};
use super::request::Subscription;
use super::step::SharedStep;
use super::stream::{Disconnected, Received};
use super::target::ShareTarget;
use crate::network::Stream;

/// A connected client.
pub(super) struct Client {
    /// The index of its server.
    pub server: usize,
    target: ShareTarget,
    stream: Box<dyn Stream>,
    outbox: Outbox,
    conversation: Conversation,
    /// `None` until the first request.
    subscription: Option<Subscription>,
    /// Lines that were dropped and not yet reported to the client.
    dropped: u64,
    /// Lines that were dropped in all.
    all_dropped: u64,
}

impl Client {
    /// Takes over a connection to the server of a target.
    pub fn new(connection: Connection, target: &ShareTarget) -> Self {
        Self {
            server: connection.server,
            target: *target,
            stream: connection.stream,
            outbox: Outbox::new(),
            conversation: Conversation::new(target),
            subscription: LineKind::of_target(target).map(Subscription::to),
            dropped: 0,
            all_dropped: 0,
        }
    }

    /// Adds the kinds that it wants of a step.
    pub fn start_step(&mut self, step: &SharedStep, wanted: &mut Wanted) {
        let kinds = match &mut self.subscription {
            Some(subscription) => subscription.start_step(step),
            None => KindSet::default(),
        };
        wanted.kinds.insert_all(kinds);
        if self.conversation.is_framed() {
            wanted.frames.insert_all(kinds);
        }
    }

    /// Returns whether the client receives [rounds](Self::push_round) of lines of this kind.
    pub fn has_rounds_of(&self, kind: LineKind) -> bool {
        LineKind::of_target(&self.target) == Some(kind)
    }

    /// Adds the lines since the last write, for a client that makes no requests.
    pub fn push_round(&mut self, round: Chunk) {
        self.outbox.push(round);
    }

    /// Adds the lines of the step that it has asked for.
    pub fn push(&mut self, lines: &[Line]) {
        if self.target.format.is_plain() {
            return;
        }
        let Some(subscription) = &self.subscription else {
            return;
        };
        for line in lines.iter().filter(|line| subscription.wants(line)) {
            if let Some(bytes) = self.conversation.bytes_of(line) {
                self.outbox.push(bytes);
            }
        }
    }

    /// Adds the layout, if it wants it and has not got it, and the number of lines that it has missed.
    pub fn catch_up(&mut self, encoder: &mut LineEncoder) {
        self.report_dropped();
        if let Some(subscription) = &mut self.subscription
            && subscription.starts_layout(encoder.layout_number())
            && let Some(bytes) = self.conversation.bytes_of(encoder.layout())
        {
            self.outbox.push(bytes);
        }
    }

    /// Writes what the client accepts. Fails if it has gone, or has read nothing for one second.
    pub fn flush(&mut self) -> Result<(), Disconnected> {
        self.outbox.flush(&mut *self.stream)?;
        let is_over = matches!(self.conversation, Conversation::Closing);
        match is_over && self.outbox.is_empty() {
            true => Err(Disconnected),
            false => Ok(()),
        }
    }

    /// Returns whether lines wait for the client.
    pub fn is_behind(&self) -> bool {
        !self.outbox.is_empty()
    }

    /// Receives what the client has sent. Fails if it has gone, or sends what it may not.
    pub fn receive(&mut self) -> Result<(), Disconnected> {
        loop {
            match self.conversation.receive(&mut *self.stream) {
                Received::Nothing => return Ok(()),
                Received::Reply(bytes) => self.outbox.push(Arc::<[u8]>::from(bytes)),
                Received::Request(request) => match Subscription::parse(&request) {
                    Ok(subscription) => self.subscription = Some(subscription),
                    Err(reason) => self.refuse(&reason),
                },
                Received::Refused(reason) => self.refuse(&reason),
                Received::Gone => return Err(Disconnected),
            }
        }
    }

    /// Sends the reason, and disconnects the client once it has read it.
    fn refuse(&mut self, reason: &str) {
        tracing::debug!("a client of {} is disconnected: {reason}", self.target);
        self.subscription = None;
        self.push_object(&json!({"kind": "error", "error": reason}));
        self.conversation = Conversation::Closing;
    }

    /// Tells a client that reads again how many lines it has missed.
    fn report_dropped(&mut self) {
        self.dropped += self.outbox.take_dropped();
        if self.dropped == 0 || !self.outbox.is_empty() {
            return;
        }
        let dropped = std::mem::take(&mut self.dropped);
        self.all_dropped += dropped;
        if !self.target.format.is_plain() {
            self.push_object(&json!({"kind": "dropped", "lines": dropped}));
        }
        if let Some(subscription) = &mut self.subscription {
            subscription.forget_layout();
        }
    }

    fn push_object(&mut self, object: &serde_json::Value) {
        let line = format!("{object}\n");
        let bytes: Arc<[u8]> = match self.conversation.is_framed() {
            true => text_frame(line.as_bytes()),
            false => line.into_bytes().into(),
        };
        self.outbox.push(bytes);
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let dropped = self.all_dropped + self.dropped + self.outbox.take_dropped();
        if dropped > 0 {
            tracing::info!("a client of {} missed {dropped} lines", self.target);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::Side;
    use crate::layout::Layout;
    use crate::network::MemoryStream;

    #[test]
    fn a_client_that_reads_late_is_told_how_many_lines_it_has_missed() {
        let stream = MemoryStream::new(0);
        let target = "json:127.0.0.1:1".parse().unwrap();
        let connection = Connection {
            server: 0,
            stream: Box::new(stream.clone()),
        };
        let mut client = Client::new(connection, &target);
        let layout = Layout::load("numpad").unwrap();
        let mut encoder = LineEncoder::new(Side::Right, layout.into());
        stream.send(b"{\"kinds\":[\"layout\"]}\n");
        assert!(client.receive().is_ok());
        client.catch_up(&mut encoder);
        let length = encoder.layout().bytes.len();
        let count = 2 * (1 << 18) / length;
        for _ in 0..count {
            let line = encoder.layout();
            client.outbox.push(line.bytes.clone());
        }
        stream.set_room(usize::MAX);
        assert!(client.flush().is_ok());
        client.catch_up(&mut encoder);
        assert!(client.flush().is_ok());
        let output = stream.take_received();
        let lines: Vec<&str> = std::str::from_utf8(&output).unwrap().lines().collect();
        let kept = (1 << 18) / length;
        let missed = format!(r#"{{"kind":"dropped","lines":{}}}"#, count + 1 - kept);
        assert_eq!(lines[kept], missed);
        assert!(lines[kept + 1].starts_with(r#"{"kind":"layout","#), "again");
        assert_eq!(lines.len(), kept + 2);
    }
}
