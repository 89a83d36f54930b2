//! The menu of the icon (`com.canonical.dbusmenu`): state, pause or resume, profiles, stop.

use std::collections::HashMap;

use zbus::blocking::Connection;
use zbus::message::Header;
use zbus::zvariant::{OwnedValue, Value};
use zbus::{fdo, interface};

use super::icon::Shared;
use super::words::heading;
use crate::session::command_channel::CommandSender;
use ademan_core::command::{Command, ProfileName};

pub const MENU_PATH: &str = "/MenuBar";
const MENU: &str = "com.canonical.dbusmenu";

/// Ids of the entries; the profiles follow from [`FIRST_PROFILE`].
const ROOT: i32 = 0;
const STATE: i32 = 1;
const PAUSE: i32 = 2;
const STOP: i32 = 3;
const SEPARATORS: [i32; 3] = [4, 5, 6];
const FIRST_PROFILE: i32 = 10;

/// Properties of an entry.
type Properties = HashMap<String, OwnedValue>;

/// An entry with its properties and the entries below it.
type Entry = (i32, Properties, Vec<OwnedValue>);

/// The object of the menu.
pub struct Menu {
    state: Shared,
    profiles: Vec<String>,
    commands: CommandSender,
}

impl Menu {
    pub fn new(state: Shared, profiles: Vec<String>, commands: CommandSender) -> Self {
        Self {
            state,
            profiles,
            commands,
        }
    }

    /// Tells readers that entries have changed.
    pub fn announce(connection: &Connection, revision: u32) {
        let none = None::<&str>;
        let body = (revision, ROOT);
        _ = connection.emit_signal(none, MENU_PATH, MENU, "LayoutUpdated", &body);
    }

    /// Returns the ids of the entries, from top to bottom.
    fn ids(&self) -> Vec<i32> {
        let profiles = (FIRST_PROFILE..).take(self.profiles.len());
        let mut ids = vec![STATE, SEPARATORS[0], PAUSE];
        // One profile leaves no choice.
        if self.profiles.len() > 1 {
            ids.push(SEPARATORS[1]);
            ids.extend(profiles);
            ids.push(SEPARATORS[2]);
        }
        ids.push(STOP);
        ids
    }

    fn properties(&self, id: i32) -> Properties {
        let state = self.state.get();
        let label = |text: &str| vec![("label", Value::from(text.replace('_', "__")))];
        let properties = match id {
            ROOT => vec![("children-display", Value::from("submenu"))],
            STATE => {
                let mut entry = label(heading(&state));
                entry.push(("enabled", Value::from(false)));
                entry
            }
            PAUSE if state.paused_by.is_some() => label("Resume"),
            PAUSE => label("Pause: release everything"),
            STOP => label("End the session"),
            id if SEPARATORS.contains(&id) => vec![("type", Value::from("separator"))],
            id => match self.profile(id) {
                Some((index, name)) => {
                    let mut entry = label(name);
                    entry.push(("toggle-type", Value::from("radio")));
                    entry.push((
                        "toggle-state",
                        Value::from(i32::from(index == state.profile)),
                    ));
                    entry
                }
                None => Vec::new(),
            },
        };
        let owned = |(name, value): (&str, Value)| {
            let value = value.try_to_owned().ok()?;
            Some((name.to_owned(), value))
        };
        properties.into_iter().filter_map(owned).collect()
    }

    /// Returns the index and the name of the profile with this id.
    fn profile(&self, id: i32) -> Option<(usize, &str)> {
        let index = usize::try_from(id.checked_sub(FIRST_PROFILE)?).ok()?;
        Some((index, self.profiles.get(index)?))
    }

    /// Executes an entry that was clicked.
    fn handle(&self, id: i32, kind: &str) {
        if let Some(command) = self.command(id).filter(|_| kind == "clicked") {
            // A full queue means that the session does not respond; the person clicks again.
            _ = self.commands.send(command);
        }
    }

    fn command(&self, id: i32) -> Option<Command> {
        match id {
            PAUSE if self.state.get().paused_by.is_some() => Some(Command::Resume),
            PAUSE => Some(Command::Pause),
            STOP => Some(Command::Stop),
            id => {
                let (_, name) = self.profile(id)?;
                let name = ProfileName::from(name).ok()?;
                Some(Command::Profile { name })
            }
        }
    }
}

/// Checks that the bus names this user as the sender of a call.
async fn check_sender(connection: &zbus::Connection, header: &Header<'_>) -> fdo::Result<()> {
    let denied =
        || fdo::Error::AccessDenied("only the user of the session may use the menu".into());
    let sender = header.sender().ok_or_else(denied)?;
    let bus = fdo::DBusProxy::new(connection).await?;
    let user = bus.get_connection_unix_user(sender.clone().into()).await?;
    if user == rustix::process::getuid().as_raw() {
        Ok(())
    } else {
        Err(denied())
    }
}

#[interface(name = "com.canonical.dbusmenu")]
impl Menu {
    fn get_layout(&self, parent: i32, depth: i32, _names: Vec<String>) -> (u32, Entry) {
        let children = match parent {
            ROOT if depth != 0 => self.ids(),
            _ => Vec::new(),
        };
        let entry = |id| {
            let entry: Entry = (id, self.properties(id), Vec::new());
            Value::from(entry).try_to_owned().ok()
        };
        let children = children.into_iter().filter_map(entry).collect();
        (
            self.state.revision(),
            (parent, self.properties(parent), children),
        )
    }

    fn get_group_properties(&self, ids: Vec<i32>, _names: Vec<String>) -> Vec<(i32, Properties)> {
        let ids = if ids.is_empty() { self.ids() } else { ids };
        ids.into_iter()
            .map(|id| (id, self.properties(id)))
            .collect()
    }

    fn get_property(&self, id: i32, name: &str) -> fdo::Result<OwnedValue> {
        let value = self.properties(id).remove(name);
        value.ok_or_else(|| fdo::Error::InvalidArgs("the entry has no such property".into()))
    }

    async fn event(
        &self,
        id: i32,
        kind: String,
        _data: Value<'_>,
        _time: u32,
        #[zbus(header)] header: Header<'_>,
        #[zbus(connection)] connection: &zbus::Connection,
    ) -> fdo::Result<()> {
        check_sender(connection, &header).await?;
        self.handle(id, &kind);
        Ok(())
    }

    async fn event_group(
        &self,
        events: Vec<(i32, String, OwnedValue, u32)>,
        #[zbus(header)] header: Header<'_>,
        #[zbus(connection)] connection: &zbus::Connection,
    ) -> fdo::Result<Vec<i32>> {
        check_sender(connection, &header).await?;
        for (id, kind, ..) in events {
            self.handle(id, &kind);
        }
        Ok(Vec::new())
    }

    fn about_to_show(&self, _id: i32) -> bool {
        false
    }

    fn about_to_show_group(&self, _ids: Vec<i32>) -> (Vec<i32>, Vec<i32>) {
        (Vec::new(), Vec::new())
    }

    #[zbus(property)]
    fn version(&self) -> u32 {
        3
    }

    #[zbus(property)]
    fn text_direction(&self) -> &str {
        "ltr"
    }

    #[zbus(property)]
    fn status(&self) -> &str {
        "normal"
    }

    #[zbus(property)]
    fn icon_theme_path(&self) -> Vec<String> {
        Vec::new()
    }
}
