//! A conversation with one client: a line is heard, a line is said; in between, news.

use std::io::{self, BufRead, BufReader, ErrorKind, Write};
use std::net::Shutdown;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded, select};

use super::notification::{Subscribers, Subscription};
use super::request::{MAX_LINE_BYTES, Request};
use super::response::{self, JsonLine};
use super::server::ServerContext;
use crate::contact::board_pose::BoardPose;
use crate::output::socket::Stream;
use crate::session::reload::{FileCall, FileCalls, FileOrder};
use crate::session::{Answer, BoardPoses, Call, Order};

/// How long a client may take nothing of what is said to it.
const PATIENCE: Duration = Duration::from_secs(1);

/// How long whoever does what was asked for may take to say so.
const ANSWER_LIMIT: Duration = Duration::from_secs(2);

const UNWATCHED: &str = "nobody looks after the layout in force";
const OVER: &str = "the run is over";
const BUSY: &str = "too much has been asked for that is not done yet";
const LATE: &str = "nothing came of it within 2 s: the run waits for its source or its output; it will do it as soon as it can";

/// Talks with a client until it goes away or does not listen any more.
pub(super) fn serve(
    stream: Stream,
    mouth: LineWriter,
    desk: &ServerContext,
    subscribers: &Subscribers,
) {
    let mut conversation = ClientConnection {
        mouth: Arc::new(mouth),
        names: desk
            .profiles
            .iter()
            .map(|profile| profile.name.clone())
            .collect(),
        desk,
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
    desk: &'a ServerContext,
    names: Vec<String>,
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
        match Request::parse(line, &self.names) {
            Err(error) => self.mouth.write_line(&response::failure(&error)),
            Ok(Request::Order(order)) => self.mouth.write_line(&self.order(order)),
            Ok(Request::Reload) => self.mouth.write_line(&self.reload()),
            Ok(Request::Scale(factor)) => self
                .mouth
                .write_line(&self.file_order(|_| FileOrder::Scale(factor))),
            Ok(Request::Save) => self.mouth.write_line(&self.file_order(FileOrder::Save)),
            Ok(Request::Subscribe) => self.subscribe(),
            Ok(Request::Stop) => {
                // First, as the end of the program is the end of this too.
                let said = self.mouth.write_line(&response::success(None));
                (self.desk.stop)();
                said
            }
        }
    }

    fn order(&self, order: Order) -> JsonLine {
        match self.answer(order) {
            Err(reason) => response::failure(&reason),
            Ok(Answer::State(run)) => response::state(&run, &self.desk.profiles),
            Ok(Answer::Done | Answer::Places(_)) => response::success(None),
        }
    }

    /// What the run answers, or why it does not do it.
    fn answer(&self, order: Order) -> Result<Answer, String> {
        let (answer, answered) = bounded(1);
        let sent = self.desk.calls.try_send(Call { order, answer });
        let answer = outcome(sent, &answered).map_err(str::to_owned)?;
        answer.map_err(|refusal| refusal.to_string())
    }

    fn reload(&self) -> JsonLine {
        let mut texts = Vec::new();
        for file in self.desk.files.iter().filter(|file| !file.is_shipped) {
            match ask(file, FileOrder::Reload) {
                Err(text) => return response::failure(&text),
                Ok(text) => texts.push(text),
            }
        }
        match texts.is_empty() {
            true => response::failure(
                "the layout comes with the program: there is no file of yours to read again",
            ),
            false => response::success(Some(&texts.join("\n"))),
        }
    }

    /// An order for whoever looks after the layout in force; it is made of where the boards are.
    fn file_order(&self, order: impl FnOnce(Vec<BoardPose>) -> FileOrder) -> JsonLine {
        let asked = self.answer(Order::Places).and_then(|answer| {
            let Answer::Places(BoardPoses { profile, boards }) = answer else {
                return Err(OVER.to_owned());
            };
            let is_in_force = |file: &&FileCalls| file.profile == usize::from(profile);
            let file = self.desk.files.iter().find(is_in_force).ok_or(UNWATCHED)?;
            ask(file, order(boards))
        });
        match asked {
            Ok(text) => response::success(Some(&text)),
            Err(reason) => response::failure(&reason),
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

/// What came of an order for whoever looks after a layout.
fn ask(file: &FileCalls, order: FileOrder) -> Result<String, String> {
    let (answer, answered) = bounded(1);
    let sent = file.calls.try_send(FileCall { order, answer });
    outcome(sent, &answered).map_err(str::to_owned)?
}

/// What came of something that was handed to another thread, or why nothing did.
fn outcome<T, A>(
    sent: Result<(), TrySendError<T>>,
    answered: &Receiver<A>,
) -> Result<A, &'static str> {
    match sent {
        Err(TrySendError::Full(_)) => return Err(BUSY),
        Err(TrySendError::Disconnected(_)) => return Err(OVER),
        Ok(()) => {}
    }
    answered
        .recv_timeout(ANSWER_LIMIT)
        .map_err(|error| match error {
            RecvTimeoutError::Timeout => LATE,
            RecvTimeoutError::Disconnected => OVER,
        })
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
