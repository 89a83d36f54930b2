//! A conversation with one client: a line is heard, a line is said; in between, news.

use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::net::Shutdown;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::notification::{Subscribers, Subscription};
use super::request::{MAX_LINE_BYTES, Request};
use super::response::{self, JsonLine};
use super::server::ServerContext;
use crate::command::Command;
use crate::output::socket::Stream;
use crate::session::command_channel::Reply;

/// How long a client may take nothing of what is said to it.
const PATIENCE: Duration = Duration::from_secs(1);

/// Talks with a client until it goes away or does not listen any more.
pub(super) fn serve(
    stream: Stream,
    mouth: LineWriter,
    context: &ServerContext,
    subscribers: &Subscribers,
) {
    let mut conversation = ClientConnection {
        mouth: Arc::new(mouth),
        context,
        subscribers,
        goes_on: None,
    };
    let mut ear = LineReader::of(stream);
    while let Ok(Some(heard)) = ear.next_line()
        && conversation.reply(heard).is_ok()
    {}
    conversation.mouth.shut();
}

struct ClientConnection<'a> {
    mouth: Arc<LineWriter>,
    context: &'a ServerContext,
    subscribers: &'a Subscribers,
    /// Ends the news when it is dropped.
    goes_on: Option<Sender<()>>,
}

impl ClientConnection<'_> {
    fn reply(&mut self, heard: ReceivedLine) -> io::Result<()> {
        let line = match heard {
            ReceivedLine::TooLong => {
                let error = format!("a line is {MAX_LINE_BYTES} bytes at most");
                return self.mouth.write_line(&response::failure(&error));
            }
            ReceivedLine::Line(line) => line,
        };
        match Request::parse(line) {
            Err(error) => self
                .mouth
                .write_line(&response::failure(&error.to_string())),
            Ok(Request::Command(Command::Stop)) => {
                // The end of the program closes this connection, so the reply comes first.
                let written = self.mouth.write_line(&response::success(None));
                let _ = self.context.commands.send(Command::Stop);
                written
            }
            Ok(Request::Command(command)) => self.mouth.write_line(&self.execute(command)),
            Ok(Request::Subscribe) => self.subscribe(),
        }
    }

    /// Executes a command in the session.
    fn execute(&self, command: Command) -> JsonLine {
        match self.context.commands.request(command) {
            Ok(Reply::Done) => response::success(None),
            Ok(Reply::Text(text)) => response::success(Some(&text)),
            Ok(Reply::State(status)) => response::state(&status, &self.context.profiles),
            Err(error) => response::failure(&error.to_string()),
        }
    }

    fn subscribe(&mut self) -> io::Result<()> {
        if self.goes_on.is_some() {
            return self
                .mouth
                .write_line(&response::failure("you have subscribed already"));
        }
        let subscription = self.subscribers.add();
        // Before any news, so that it is told from them by its place.
        self.mouth.write_line(&response::success(None))?;
        let (goes_on, over) = bounded(0);
        let mouth = self.mouth.clone();
        thread::Builder::new()
            .name("control news".into())
            .spawn(move || pass_on(&subscription, &mouth, &over))?;
        self.goes_on = Some(goes_on);
        Ok(())
    }
}

/// Says the news until the conversation is over or nobody listens.
fn pass_on(subscription: &Subscription, mouth: &LineWriter, over: &Receiver<()>) {
    loop {
        let line = select! {
            recv(subscription.lines) -> line => line.ok(),
            recv(over) -> _ => None,
        };
        let Some(line) = line else {
            return;
        };
        let missed = subscription.take_missed();
        let told = match missed {
            0 => Ok(()),
            count => mouth.write_line(&response::missed_notification(count)),
        };
        if told.and_then(|()| mouth.write_line(&line)).is_err() {
            return;
        }
    }
}

/// Where lines are said to a client.
pub(super) struct LineWriter(Mutex<Stream>);

impl LineWriter {
    /// That of a stream; the stream stays to be read.
    pub fn new(stream: &Stream) -> io::Result<Self> {
        let stream = stream.try_clone()?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(Self(Mutex::new(stream)))
    }

    /// Says a whole line. A client that takes nothing for 1 s, or is gone, is cut off: that is an error.
    pub fn write_line(&self, line: &JsonLine) -> io::Result<()> {
        let mut stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let written = stream.write_all(format!("{line}\n").as_bytes());
        if written.is_err() {
            let _ = stream.shutdown(Shutdown::Both);
        }
        written
    }

    fn shut(&self) {
        let stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = stream.shutdown(Shutdown::Both);
    }
}

/// What a client said.
enum ReceivedLine<'a> {
    /// A line without its end.
    Line(&'a [u8]),
    /// A line that is longer than one can be; none of it was kept.
    TooLong,
}

/// Hears a client, line by line.
struct LineReader {
    reader: BufReader<Stream>,
    line: Vec<u8>,
}

impl LineReader {
    fn of(stream: Stream) -> Self {
        Self {
            reader: BufReader::new(stream),
            line: Vec::with_capacity(MAX_LINE_BYTES),
        }
    }

    /// Waits for a line; `None` when no more come. What has no line end is none.
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
            let used = part.len() + usize::from(end.is_some());
            self.reader.consume(used);
            if end.is_some() {
                return Ok(Some(match is_too_long {
                    true => ReceivedLine::TooLong,
                    false => ReceivedLine::Line(&self.line),
                }));
            }
        }
    }
}
