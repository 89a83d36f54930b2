//! A program in a terminal of a given size, and what its screen shows.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::process::{Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::termios::{InputModes, LocalModes, OptionalActions, OutputModes, Winsize};
use rustix::termios::{tcgetattr, tcsetattr, tcsetwinsize};
use serialport::{SerialPort, TTYPort};
use vt100::{Cell, Parser};

use crate::support::process::{Process, lock_spawning};
use crate::support::run::TIMEOUT;

/// A terminal, and the program in its foreground.
pub struct Screen {
    pub program: Process,
    keyboard: TTYPort,
    /// Kept open: its size can be changed, and its modes read.
    terminal: File,
    parser: Arc<Mutex<Parser>>,
    /// Everything that was written.
    bytes: Arc<Mutex<Vec<u8>>>,
    is_read: Arc<AtomicBool>,
}

impl Screen {
    /// Starts a program in a terminal of this size, which is read.
    pub fn start(command: &Command, columns: u16, rows: u16) -> Self {
        let screen = Self::start_unread(command, columns, rows);
        screen.read();
        screen
    }

    /// Starts a program in a terminal that is not read before [`read`](Self::read).
    pub fn start_unread(command: &Command, columns: u16, rows: u16) -> Self {
        let alone = lock_spawning();
        let (mut keyboard, local_end) = TTYPort::pair().expect("a pseudo-terminal");
        keyboard
            .set_timeout(Duration::from_millis(20))
            .expect("a timeout");
        let name = local_end.name().expect("a device name");
        let terminal = File::options().read(true).write(true).open(name);
        let terminal = terminal.expect("a terminal");
        make_cooked(&terminal);
        set_size(&terminal, columns, rows);
        // `setsid` makes it the controlling terminal, which sends signals for keys.
        let mut session = Command::new("setsid");
        session
            .arg("--ctty")
            .arg(command.get_program())
            .args(command.get_args());
        for (variable, value) in command.get_envs() {
            match value {
                Some(value) => session.env(variable, value),
                None => session.env_remove(variable),
            };
        }
        if let Some(folder) = command.get_current_dir() {
            session.current_dir(folder);
        }
        let stream = || terminal.try_clone().expect("a terminal");
        session.stdin(stream()).stdout(stream()).stderr(stream());
        drop(alone);
        let program = Process::start(&mut session).expect("setsid of util-linux");
        let screen = Self {
            program,
            keyboard,
            terminal,
            parser: Arc::new(Mutex::new(Parser::new(rows, columns, 200))),
            bytes: Arc::default(),
            is_read: Arc::default(),
        };
        drop(local_end);
        screen.start_reader();
        screen
    }

    fn start_reader(&self) {
        let mut reader = self.keyboard.try_clone_native().expect("a clone");
        let (parser, bytes) = (Arc::clone(&self.parser), Arc::clone(&self.bytes));
        let is_read = Arc::clone(&self.is_read);
        thread::spawn(move || {
            let mut buffer = [0; 4096];
            loop {
                if !is_read.load(Ordering::Relaxed) {
                    thread::sleep(Duration::from_millis(5));
                    continue;
                }
                match reader.read(&mut buffer) {
                    Ok(0) => return,
                    Ok(length) => {
                        parser.lock().unwrap().process(&buffer[..length]);
                        bytes.lock().unwrap().extend(&buffer[..length]);
                    }
                    Err(error) if error.kind() == ErrorKind::TimedOut => {}
                    Err(_) => return,
                }
            }
        });
    }

    /// Reads the terminal from now on.
    pub fn read(&self) {
        self.is_read.store(true, Ordering::Relaxed);
    }

    /// Returns `true` if the terminal accepts nothing before it is read.
    pub fn is_full(&self) -> bool {
        let mut terminal = [PollFd::new(&self.terminal, PollFlags::OUT)];
        poll(&mut terminal, Some(&Timespec::default())) == Ok(0)
    }

    /// Types keys.
    pub fn type_keys(&mut self, keys: &str) {
        self.keyboard
            .write_all(keys.as_bytes())
            .expect("a terminal");
    }

    /// Changes the size of the window.
    pub fn resize(&self, columns: u16, rows: u16) {
        self.parser().screen_mut().set_size(rows, columns);
        set_size(&self.terminal, columns, rows);
    }

    /// Returns what the screen shows.
    pub fn text(&self) -> String {
        self.parser().screen().contents()
    }

    /// Returns everything that was written so far.
    pub fn written(&self) -> Vec<u8> {
        self.bytes.lock().unwrap().clone()
    }

    /// Returns the text of the cells that satisfy a condition.
    pub fn text_where(&self, condition: impl Fn(&Cell) -> bool) -> String {
        let parser = self.parser();
        let (rows, columns) = parser.screen().size();
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let cells = cells.filter_map(|(row, column)| parser.screen().cell(row, column));
        cells
            .filter(|cell| condition(cell))
            .map(Cell::contents)
            .collect()
    }

    /// Waits until the screen satisfies a condition, and returns its text.
    pub fn wait_for(&self, what: &str, condition: impl Fn(&Self) -> bool) -> String {
        let start = Instant::now();
        while !condition(self) {
            assert!(start.elapsed() < TIMEOUT, "no {what}:\n{}", self.text());
            thread::sleep(Duration::from_millis(3));
        }
        self.text()
    }

    /// Waits until the screen shows a text, and returns all that it shows with it.
    pub fn wait_for_text(&self, text: &str) -> String {
        self.wait_until(text, |shown| shown.contains(text))
    }

    /// Waits until what the screen shows satisfies a condition, and returns it. The screen may show something else right after.
    pub fn wait_until(&self, what: &str, condition: impl Fn(&str) -> bool) -> String {
        let start = Instant::now();
        loop {
            let shown = self.text();
            if condition(&shown) {
                return shown;
            }
            assert!(start.elapsed() < TIMEOUT, "no {what}:\n{shown}");
            thread::sleep(Duration::from_millis(3));
        }
    }

    /// Waits for the end of the program and, if the terminal is read, of what it wrote.
    pub fn wait(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.program.0.try_wait().expect("a child process") {
                self.wait_for_output();
                return status;
            }
            assert!(start.elapsed() < TIMEOUT, "it goes on:\n{}", self.text());
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until everything that was written is on the screen.
    fn wait_for_output(&mut self) {
        if !self.is_read.load(Ordering::Relaxed) {
            return;
        }
        // No program writes this, and it changes nothing.
        let mark = b"\x1b[0;0;0m";
        self.terminal.write_all(mark).expect("a terminal");
        self.wait_for("end of the output", |screen| {
            screen.bytes.lock().unwrap().ends_with(mark)
        });
    }

    /// Asserts that the terminal is as it was at the start.
    pub fn assert_restored(&self) {
        let modes = tcgetattr(&self.terminal).expect("a terminal").local_modes;
        assert!(
            modes.contains(LocalModes::ECHO | LocalModes::ICANON),
            "{modes:?}"
        );
        let parser = self.parser();
        assert!(!parser.screen().alternate_screen());
        assert!(!parser.screen().hide_cursor());
    }

    fn parser(&self) -> MutexGuard<'_, Parser> {
        self.parser.lock().unwrap()
    }
}

fn set_size(terminal: &File, columns: u16, rows: u16) {
    let size = Winsize {
        ws_row: rows,
        ws_col: columns,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(terminal, size).expect("a terminal");
}

/// Sets the modes of a terminal of a shell.
fn make_cooked(terminal: &File) {
    let mut modes = tcgetattr(terminal).expect("a terminal");
    modes.local_modes |= LocalModes::ECHO | LocalModes::ICANON | LocalModes::ISIG;
    modes.input_modes |= InputModes::IXON | InputModes::ICRNL;
    modes.output_modes |= OutputModes::OPOST | OutputModes::ONLCR;
    tcsetattr(terminal, OptionalActions::Now, &modes).expect("a terminal");
}
