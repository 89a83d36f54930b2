//! The connection to one client: requests and responses, and notifications in between.

use std::io::{self, BufRead, BufReader, ErrorKind};
use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::clients::{ClientSlot, MAX_SUBSCRIBERS};
use super::context::ServerContext;
use super::line_writer::LineWriter;
use super::notification::{Subscribers, Subscription};
use super::request::{MAX_LINE_BYTES, Request};
use super::response::{self, JsonLine, SessionContext};
use crate::output::socket::Stream;
use crate::session::reply::Reply;
use crate::session::view::{ViewHub, Viewer};
use ademan_core::command::Command;
use ademan_core::layout::Layout;

/// Serves a client until it disconnects or stops reading.
pub(super) fn serve(
    stream: &Stream,
    writer: Arc<LineWriter>,
    slot: &ClientSlot,
    context: &ServerContext,
    subscribers: &Subscribers,
) {
    let mut connection = ClientConnection {
        writer,
        slot,
        context,
        subscribers,
        notifications: None,
    };
    let mut reader = LineReader::new(stream);
    while let Ok(Some(line)) = reader.next_line()
        && slot.begin_request()
        && connection.handle(line).is_ok()
    {
        slot.end_request();
    }
    connection.writer.shutdown();
}

struct ClientConnection<'a> {
    writer: Arc<LineWriter>,
    slot: &'a ClientSlot,
    context: &'a ServerContext,
    subscribers: &'a Subscribers,
    /// Ends the thread that writes notifications when it is dropped.
    notifications: Option<Sender<()>>,
}

impl ClientConnection<'_> {
    fn handle(&mut self, line: ReceivedLine) -> io::Result<()> {
        let line = match line {
            ReceivedLine::TooLong => {
                let error = format!("a line has at most {MAX_LINE_BYTES} bytes");
                return self.writer.write_line(&response::failure(&error));
            }
            ReceivedLine::Line(line) => line,
        };
        match Request::parse(line) {
            Err(error) => self
                .writer
                .write_line(&response::failure(&error.to_string())),
            Ok(Request::Command(Command::Stop)) => {
                // The end of the program closes this connection, so the response comes first.
                let written = self.writer.write_line(&response::success(None));
                let _ = self.context.commands.send(Command::Stop);
                written
            }
            Ok(Request::Command(command)) => self.writer.write_line(&self.execute(command)),
            Ok(Request::Subscribe) => self.subscribe(),
            Ok(Request::Watch) => self.watch(),
        }
    }

    /// Executes a command in the session and returns the response.
    fn execute(&self, command: Command) -> JsonLine {
        match self.context.commands.request(command) {
            Ok(Reply::Done) => response::success(None),
            Ok(Reply::Text(text)) => response::success(Some(&text)),
            Ok(Reply::State(status)) => {
                let incomplete = self.context.write_failures.reasons();
                let headset = self.context.views.as_ref().and_then(ViewHub::headset);
                let context = SessionContext {
                    profiles: &self.context.profiles,
                    application: self.context.rule.application(),
                    headset,
                    incomplete: &incomplete,
                };
                response::state(&status, context)
            }
            Err(error) => response::failure(&error.to_string()),
        }
    }

    fn subscribe(&mut self) -> io::Result<()> {
        let subscribers = self.subscribers;
        self.start_notifications(|| {
            let subscription = subscribers.add();
            move |writer: &LineWriter, end: &_| write_notifications(&subscription, writer, end)
        })
    }

    fn watch(&mut self) -> io::Result<()> {
        let Some(views) = &self.context.views else {
            let error = "this session has no views";
            return self.writer.write_line(&response::failure(error));
        };
        self.start_notifications(|| {
            let viewer = views.add_viewer();
            move |writer: &LineWriter, end: &_| write_views(&viewer, writer, end)
        })
    }

    /// Starts a thread that writes lines until the connection ends. `prepare` is called if the client may receive them.
    fn start_notifications<W>(&mut self, prepare: impl FnOnce() -> W) -> io::Result<()>
    where
        W: FnOnce(&LineWriter, &Receiver<()>) + Send + 'static,
    {
        if self.notifications.is_some() {
            let error = "this connection has subscribed already";
            return self.writer.write_line(&response::failure(error));
        }
        if !self.slot.subscribe() {
            let error = format!("at most {MAX_SUBSCRIBERS} clients can subscribe; end one of them");
            return self.writer.write_line(&response::failure(&error));
        }
        let write = prepare();
        // The response precedes the first notification.
        self.writer.write_line(&response::success(None))?;
        let (notifications, end) = bounded(0);
        let writer = self.writer.clone();
        thread::Builder::new()
            .name("control notify".into())
            .spawn(move || write(&writer, &end))?;
        self.notifications = Some(notifications);
        Ok(())
    }
}

/// Writes notifications until the connection ends.
fn write_notifications(subscription: &Subscription, writer: &LineWriter, end: &Receiver<()>) {
    loop {
        let line = select! {
            recv(subscription.lines) -> line => line.ok(),
            recv(end) -> _ => None,
        };
        let Some(line) = line else {
            return;
        };
        let written = match subscription.take_missed() {
            0 => Ok(()),
            count => writer.write_line(&response::missed_notification(count)),
        };
        if written.and_then(|()| writer.write_line(&line)).is_err() {
            return;
        }
    }
}

/// Writes views, each after its layout if the layout is new, until the connection ends. The end of the session disconnects the client,
/// even if the process continues.
fn write_views(viewer: &Viewer, writer: &LineWriter, end: &Receiver<()>) {
    let mut written: Option<Arc<Layout>> = None;
    loop {
        let view = select! {
            recv(viewer.views()) -> view => view,
            recv(end) -> _ => return,
        };
        let Ok(view) = view else {
            writer.shutdown();
            return;
        };
        let is_known = |layout: &Arc<Layout>| Arc::ptr_eq(layout, &view.layout);
        if !written.as_ref().is_some_and(is_known) {
            if writer
                .write_line(&response::layout_notification(&view.layout))
                .is_err()
            {
                return;
            }
            written = Some(Arc::clone(&view.layout));
        }
        if writer
            .write_line(&response::view_notification(&view))
            .is_err()
        {
            return;
        }
    }
}

/// A line from a client.
enum ReceivedLine<'a> {
    /// The line without the newline.
    Line(&'a [u8]),
    /// A line above the maximum length, which was discarded.
    TooLong,
}

/// The reading end of a connection.
struct LineReader<'a> {
    reader: BufReader<&'a Stream>,
    line: Vec<u8>,
}

impl<'a> LineReader<'a> {
    fn new(stream: &'a Stream) -> Self {
        Self {
            reader: BufReader::new(stream),
            line: Vec::with_capacity(MAX_LINE_BYTES),
        }
    }

    /// Waits for a line. Returns `None` at the end of the stream; an incomplete last line is discarded.
    fn next_line(&mut self) -> io::Result<Option<ReceivedLine<'_>>> {
        self.line.clear();
        let mut is_too_long = false;
        loop {
            let bytes = match self.reader.fill_buf() {
                Ok([]) => return Ok(None),
                Ok(bytes) => bytes,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            let end = bytes.iter().position(|&byte| byte == b'\n');
            let part = &bytes[..end.unwrap_or(bytes.len())];
            is_too_long |= self.line.len() + part.len() > MAX_LINE_BYTES;
            if !is_too_long {
                self.line.extend_from_slice(part);
            }
            let consumed = part.len() + usize::from(end.is_some());
            self.reader.consume(consumed);
            if end.is_some() {
                return Ok(Some(if is_too_long {
                    ReceivedLine::TooLong
                } else {
                    ReceivedLine::Line(&self.line)
                }));
            }
        }
    }
}
