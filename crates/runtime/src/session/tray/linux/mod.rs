//! The thread that talks to the session bus.

mod icon;
mod menu;
mod notification;
mod words;

use std::time::{Duration, Instant};
use std::{io, thread};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded, never, select};
use zbus::blocking::connection::Builder;
use zbus::blocking::{Connection, MessageIterator};

use self::icon::Icon;
use self::notification::Notifications;
use super::{TraySettings, TrayState};
use crate::session::command_channel::CommandSender;

/// The longest that a program on the bus may take to answer.
const TIMEOUT: Duration = Duration::from_secs(2);

/// The bus itself, and its object.
const BUS: &str = "org.freedesktop.DBus";
const BUS_PATH: &str = "/org/freedesktop/DBus";

/// The service that shows the icons of a tray, and its object.
const WATCHER: &str = "org.kde.StatusNotifierWatcher";
const WATCHER_PATH: &str = "/StatusNotifierWatcher";

const NO_TRAY: &str = "no icon in the tray: no program of this desktop shows icons (`org.kde.StatusNotifierWatcher`); on GNOME the extension \
                       AppIndicator does";

/// Starts the thread.
pub fn start(
    settings: TraySettings,
    commands: CommandSender,
    states: Receiver<TrayState>,
    report: impl Fn(String) + Send + Sync + 'static,
) -> io::Result<()> {
    let run = move || {
        if let Err(reason) = run(settings, commands, &states, &report) {
            report(reason);
        }
    };
    thread::Builder::new()
        .name("tray".into())
        .spawn(run)
        .map(drop)
}

/// Shows states until the session ends. The error says why the bus failed.
fn run(
    settings: TraySettings,
    commands: CommandSender,
    states: &Receiver<TrayState>,
    report: &impl Fn(String),
) -> Result<(), String> {
    let connection = Builder::session()
        .and_then(|builder| builder.method_timeout(TIMEOUT).build())
        .map_err(|error| format!("neither tray nor notifications: the session bus of the desktop cannot be reached: {error}"))?;
    let failed = |error: zbus::Error| format!("no icon in the tray: {error}");
    let watchers = watcher_changes(&connection).map_err(failed)?;
    let mut icon = None;
    if settings.has_icon {
        let shown = Icon::publish(&connection, settings.profiles, commands).map_err(failed)?;
        if !shown.register() {
            report(NO_TRAY.into());
        }
        icon = Some(shown);
    }
    let mut notifications = settings.notifies.then(|| Notifications::new(&connection));
    loop {
        let due = notifications.as_ref().and_then(Notifications::due);
        let due = due.map_or(never(), crossbeam_channel::at);
        select! {
            recv(states) -> state => {
                let Ok(state) = state else {
                    return Ok(());
                };
                if let Some(icon) = &icon {
                    icon.show(state);
                }
                if let Some(notifications) = &mut notifications {
                    notifications.push(state);
                }
            }
            recv(watchers) -> change => {
                if change.is_err() {
                    return Err("neither tray nor notifications from now on: the session bus of the desktop has ended".into());
                }
                if let Some(icon) = &icon {
                    icon.register();
                }
            }
            recv(due) -> _ => {}
        }
        if let Some(notifications) = &mut notifications
            && let Err(reason) = notifications.send(Instant::now())
        {
            report(reason);
        }
    }
}

/// Returns a channel with a message for each program that begins to show the icons of trays; disconnected when the bus ends.
fn watcher_changes(connection: &Connection) -> zbus::Result<Receiver<()>> {
    // Messages of all kinds pass by: an iterator with a rule of its own warns when it cannot remove the rule from a bus that has ended.
    let messages = MessageIterator::from(connection);
    let rule = format!("type='signal',sender='{BUS}',member='NameOwnerChanged',arg0='{WATCHER}'");
    connection.call_method(Some(BUS), BUS_PATH, Some(BUS), "AddMatch", &(rule,))?;
    let (changes, received) = bounded(1);
    let read = move || read(messages, &changes);
    thread::Builder::new()
        .name("tray in".into())
        .spawn(read)
        .map_err(|error| zbus::Error::InputOutput(error.into()))?;
    Ok(received)
}

fn read(messages: MessageIterator, changes: &Sender<()>) {
    for message in messages {
        let Ok(message) = message else { return };
        let header = message.header();
        let is_change = header
            .member()
            .is_some_and(|member| member == "NameOwnerChanged");
        let owners = message.body();
        let is_new = || {
            let owners = owners.deserialize::<(&str, &str, &str)>();
            owners.is_ok_and(|(name, _, new)| name == WATCHER && !new.is_empty())
        };
        // One that waits says the same. A full channel must not delay the replies to other calls.
        if is_change
            && is_new()
            && matches!(changes.try_send(()), Err(TrySendError::Disconnected(_)))
        {
            return;
        }
    }
}
