//! The connection to the IBus daemon.

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::{env, fs, thread};

use crossbeam_channel::{Receiver, bounded};
use etcetera::BaseStrategy;
use serde::Serialize;
use zbus::Message;
use zbus::blocking::connection::Builder;
use zbus::blocking::{Connection, MessageIterator};
use zbus::zvariant::{DynamicType, OwnedValue, Value};

use super::serial;
use ademan_core::message::escape_path;

const DAEMON: &str = "org.freedesktop.IBus";
const DAEMON_PATH: &str = "/org/freedesktop/IBus";
const PROPERTIES: &str = "org.freedesktop.DBus.Properties";

/// The object of the engine.
pub(super) const ENGINE_PATH: &str = "/org/freedesktop/IBus/Engine/Ademan";
const ENGINE_INTERFACE: &str = "org.freedesktop.IBus.Engine";

/// The longest that the daemon may take to answer a request at the start.
const TIMEOUT: std::time::Duration = std::time::Duration::from_secs(2);

/// Longest time that the end of a session waits for the daemon to notice it, and the time between two looks.
const RESTORE_TIMEOUT: std::time::Duration = std::time::Duration::from_millis(200);
const RESTORE_PERIOD: std::time::Duration = std::time::Duration::from_millis(10);

/// A connection to the daemon that knows the engine.
pub(super) struct Bus {
    connection: Connection,
    /// The messages of the daemon; disconnected after its end.
    pub messages: Receiver<Message>,
    /// The engine of the desktop before.
    previous: Option<String>,
}

impl Bus {
    /// Connects to the daemon of the desktop, registers the engine, and asks for it to be the desktop's. The error says what to do.
    pub(super) fn connect() -> Result<Self, String> {
        let address = address()?;
        let connection = open(&address)?;
        let messages = read(&connection)?;
        let bus = Self {
            connection,
            messages,
            previous: None,
        };
        match bus.register() {
            Ok(previous) => Ok(Self { previous, ..bus }),
            Err(reason) => {
                bus.end_connection();
                Err(reason)
            }
        }
    }

    /// Registers the engine, and asks for it to be the desktop's. Returns the engine of the desktop before.
    fn register(&self) -> Result<Option<String>, String> {
        let component = (Value::from(serial::component()),);
        call(&self.connection, DAEMON, "RegisterComponent", &component)
            .map_err(|error| format!("IBus refuses the engine: {error}"))?;
        let previous = self.global_engine().filter(|name| name != serial::ENGINE);
        self.select(serial::ENGINE)
            .map_err(|error| format!("IBus does not select the engine: {error}"))?;
        Ok(previous)
    }

    /// Ends the connection, which its thread would keep open until the next message. Returns `true` if it was open.
    fn end_connection(&self) -> bool {
        self.connection.clone().close().is_ok()
    }

    /// Ends the connection, and makes the engine before the desktop's again.
    ///
    /// A daemon takes the engine of the desktop away when a program with an engine goes, even if another one has been selected by then, so
    /// this waits for it.
    pub(super) fn close(self) {
        let selected = self.global_engine();
        let is_ended = self.end_connection();
        let previous = selected.filter(|it| it != serial::ENGINE).or(self.previous);
        let Some(previous) = previous.filter(|_| is_ended) else {
            return;
        };
        let _ = address().and_then(|address| {
            let connection = open(&address)?;
            let is_gone = || global_engine(&connection).is_none();
            let polls = RESTORE_TIMEOUT.as_millis() / RESTORE_PERIOD.as_millis();
            for _ in 0..polls {
                if is_gone() {
                    break;
                }
                thread::sleep(RESTORE_PERIOD);
            }
            call(&connection, DAEMON, "SetGlobalEngine", &(previous,))
                .map_err(|error| error.to_string())
        });
    }

    /// Asks for an engine to be the desktop's. Does not wait: the daemon creates it first, for which it asks the engine's program.
    fn select(&self, engine: &str) -> zbus::Result<NonZeroU32> {
        self.ask(DAEMON, "SetGlobalEngine", &(engine,))
    }

    /// Calls a method without waiting. Returns the serial number of the call, which the answer repeats.
    fn ask<B: Serialize + DynamicType>(
        &self,
        interface: &str,
        method: &str,
        body: &B,
    ) -> zbus::Result<NonZeroU32> {
        let message = Message::method_call(DAEMON_PATH, method)?
            .destination(DAEMON)?
            .interface(interface)?
            .build(body)?;
        self.connection.send(&message)?;
        Ok(message.primary_header().serial_num())
    }

    /// Asks which context has the focus. Returns the serial number of the question.
    pub(super) fn ask_context(&self) -> zbus::Result<NonZeroU32> {
        self.ask(PROPERTIES, "Get", &(DAEMON, "CurrentInputContext"))
    }

    fn global_engine(&self) -> Option<String> {
        global_engine(&self.connection)
    }

    /// Emits a signal of the engine.
    pub(super) fn emit<B: Serialize + DynamicType>(
        &self,
        signal: &str,
        body: &B,
    ) -> zbus::Result<()> {
        self.connection
            .emit_signal(None::<&str>, ENGINE_PATH, ENGINE_INTERFACE, signal, body)
    }

    /// Replies to a call of the daemon.
    pub(super) fn reply<B: Serialize + DynamicType>(
        &self,
        call: &Message,
        body: &B,
    ) -> zbus::Result<()> {
        self.connection.reply(&call.header(), body)
    }

    /// Refuses a call of a method that the engine does not have.
    pub(super) fn refuse_method(&self, call: &Message) -> zbus::Result<()> {
        let error = "org.freedesktop.DBus.Error.UnknownMethod";
        let reason = "the engine has no such method";
        self.connection
            .reply_error(&call.header(), error, &(reason,))
    }

    /// Refuses a call with other arguments than the method has.
    pub(super) fn refuse_arguments(&self, call: &Message) -> zbus::Result<()> {
        let error = "org.freedesktop.DBus.Error.InvalidArgs";
        let reason = "the method has other arguments";
        self.connection
            .reply_error(&call.header(), error, &(reason,))
    }
}

fn open(address: &str) -> Result<Connection, String> {
    Builder::address(address)
        .and_then(|builder| builder.method_timeout(TIMEOUT).build())
        .map_err(|error| format!("the IBus daemon cannot be reached: {error}; {START_IT}"))
}

fn call<B: Serialize + DynamicType>(
    connection: &Connection,
    interface: &str,
    method: &str,
    body: &B,
) -> zbus::Result<Message> {
    connection.call_method(Some(DAEMON), DAEMON_PATH, Some(interface), method, body)
}

/// Returns the name of the engine of the desktop, if it has one.
fn global_engine(connection: &Connection) -> Option<String> {
    let reply = call(connection, PROPERTIES, "Get", &(DAEMON, "GlobalEngine")).ok()?;
    let description: OwnedValue = reply.body().deserialize().ok()?;
    serial::engine_name(&description)
}

const START_IT: &str =
    "start it with `ibus-daemon --daemonize --replace --xim`, or use the output `desktop`";

/// Passes the messages of a connection to a channel, from a thread that ends with the connection or the receiver.
fn read(connection: &Connection) -> Result<Receiver<Message>, String> {
    let incoming = MessageIterator::from(connection);
    let (messages, received) = bounded(16);
    let read = move || {
        for message in incoming {
            let Ok(message) = message else { break };
            if messages.send(message).is_err() {
                break;
            }
        }
    };
    thread::Builder::new()
        .name("input method in".into())
        .spawn(read)
        .map_err(|error| crate::advice::no_thread(&error).to_string())?;
    Ok(received)
}

/// Returns the address of the daemon for the display of this session, as libibus finds it.
fn address() -> Result<String, String> {
    if let Some(address) = env::var("IBUS_ADDRESS").ok().filter(|it| !it.is_empty()) {
        return Ok(address);
    }
    let file = address_file()?;
    let text = fs::read_to_string(&file).map_err(|_| {
        let name = escape_path(&file);
        format!("IBus does not run for this display (there is no {name}); {START_IT}")
    })?;
    text.lines()
        .find_map(|line| line.strip_prefix("IBUS_ADDRESS="))
        .map(str::to_owned)
        .ok_or_else(|| format!("{} has no address; {START_IT}", escape_path(&file)))
}

/// Returns the file with the address: `ibus/bus/MACHINE-HOST-DISPLAY` in the folder of settings.
fn address_file() -> Result<PathBuf, String> {
    if let Some(file) = env::var_os("IBUS_ADDRESS_FILE") {
        return Ok(file.into());
    }
    let display = |name| {
        env::var(name)
            .ok()
            .filter(|display: &String| !display.is_empty())
    };
    let display = display("WAYLAND_DISPLAY").or_else(|| display("DISPLAY"));
    let display =
        display.ok_or("there is no display: neither WAYLAND_DISPLAY nor DISPLAY is set")?;
    let machine = ["/etc/machine-id", "/var/lib/dbus/machine-id"]
        .iter()
        .find_map(|file| fs::read_to_string(file).ok())
        .ok_or("this machine has no machine-id, by which IBus names its address; `dbus-uuidgen --ensure` makes one")?;
    let settings = etcetera::choose_base_strategy()
        .map_err(|error| format!("the folder of settings is not known: {error}"))?
        .config_dir();
    Ok(file_of_display(&settings, machine.trim(), &display))
}

fn file_of_display(settings: &Path, machine: &str, display: &str) -> PathBuf {
    // `HOST:NUMBER.SCREEN`; the display of a compositor has neither.
    let (host, number) = match display.split_once(':') {
        Some((host, number)) => (host, number.split('.').next().unwrap_or(number)),
        None => ("", display),
    };
    let host = if host.is_empty() { "unix" } else { host };
    settings
        .join("ibus/bus")
        .join(format!("{machine}-{host}-{number}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_of_the_address_has_the_name_that_libibus_gives_it() {
        let name = |display| {
            let file = file_of_display(Path::new("/c"), "m", display);
            file.display().to_string()
        };
        assert_eq!(name(":1"), "/c/ibus/bus/m-unix-1");
        assert_eq!(name("host:10.0"), "/c/ibus/bus/m-host-10");
        assert_eq!(name("wayland-0"), "/c/ibus/bus/m-unix-wayland-0");
    }
}
