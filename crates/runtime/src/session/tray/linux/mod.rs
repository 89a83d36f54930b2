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
use self::notification::{Notifications, ShownId};
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
                       AppIndicator does; the icon appears once such a program starts";

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

/// Shows states until the session ends. The error states why the bus failed.
fn run(
    settings: TraySettings,
    commands: CommandSender,
    states: &Receiver<TrayState>,
    report: &impl Fn(String),
) -> Result<(), String> {
    let connection = Builder::session()
        .and_then(|builder| builder.method_timeout(TIMEOUT).build())
        .map_err(|error| format!("neither tray nor notifications: the session bus of the desktop cannot be reached: {error}"))?;
    let notification = ShownId::default();
    let watchers = watcher_changes(&connection, notification.clone())
        .map_err(|error| format!("neither tray nor notifications: {error}"))?;
    let icon = if settings.has_icon {
        let published = publish_icon(&connection, settings.profiles, commands, report);
        // Notifications need no icon.
        published.map_err(report).ok()
    } else {
        None
    };
    if icon.is_none() && !settings.notifies {
        return Ok(());
    }
    let mut notifications = settings
        .notifies
        .then(|| Notifications::new(&connection, notification));
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

/// Creates the icon and asks the tray to show it.
fn publish_icon(
    connection: &Connection,
    profiles: Vec<String>,
    commands: CommandSender,
    report: &impl Fn(String),
) -> Result<Icon, String> {
    let icon = Icon::publish(connection, profiles, commands)
        .map_err(|error| format!("no icon in the tray: {error}"))?;
    if !icon.register() {
        report(NO_TRAY.into());
    }
    Ok(icon)
}

/// Returns a channel with a message for each program that begins to show the icons of trays; disconnected when the bus ends. A
/// notification that is closed is forgotten.
fn watcher_changes(connection: &Connection, notification: ShownId) -> zbus::Result<Receiver<()>> {
    // Messages of all kinds pass by: an iterator with a rule of its own warns when it cannot remove the rule from a bus that has ended.
    let messages = MessageIterator::from(connection);
    let owner =
        |name| format!("type='signal',sender='{BUS}',member='NameOwnerChanged',arg0='{name}'");
    let service = notification::SERVICE;
    let closed = format!(
        "type='signal',sender='{service}',interface='{service}',member='NotificationClosed'"
    );
    for rule in [owner(WATCHER), owner(service), closed] {
        connection.call_method(Some(BUS), BUS_PATH, Some(BUS), "AddMatch", &(rule,))?;
    }
    let (changes, received) = bounded(1);
    let read = move || read(messages, &changes, &notification);
    thread::Builder::new()
        .name("tray in".into())
        .spawn(read)
        .map_err(|error| zbus::Error::InputOutput(error.into()))?;
    Ok(received)
}

fn read(messages: MessageIterator, changes: &Sender<()>, notification: &ShownId) {
    for message in messages {
        let Ok(message) = message else { return };
        let header = message.header();
        let body = message.body();
        match header.member().map(|member| member.as_str()) {
            Some("NotificationClosed") => {
                if let Ok((id, _)) = body.deserialize::<(u32, u32)>() {
                    notification.close(id);
                }
            }
            Some("NameOwnerChanged") => match body.deserialize::<(&str, &str, &str)>() {
                Ok((notification::SERVICE, _, _)) => notification.forget(),
                // One that waits says the same. A full channel must not delay the replies to other calls.
                Ok((WATCHER, _, new))
                    if !new.is_empty()
                        && matches!(changes.try_send(()), Err(TrySendError::Disconnected(_))) =>
                {
                    return;
                }
                _ => {}
            },
            _ => {}
        }
    }
}
