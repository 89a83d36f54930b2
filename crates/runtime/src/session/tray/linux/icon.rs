//! The icon in the tray (`org.kde.StatusNotifierItem`).

use std::process;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use zbus::blocking::Connection;
use zbus::interface;
use zbus::zvariant::ObjectPath;

use super::super::TrayState;
use super::menu::{MENU_PATH, Menu};
use super::words::{Condition, condition, heading, sentence};
use super::{BUS, BUS_PATH, WATCHER, WATCHER_PATH};
use crate::session::command_channel::CommandSender;

const ITEM_PATH: &str = "/StatusNotifierItem";
const ITEM: &str = "org.kde.StatusNotifierItem";

/// The flag of a request for a name that is refused if another program has it.
const DO_NOT_QUEUE: u32 = 4;

/// A picture of a size, as bytes; the tray has names of icons instead.
type Pixmap = (i32, i32, Vec<u8>);

/// The state that the bus reads, shared with the thread that sets it.
#[derive(Clone)]
pub struct Shared(Arc<Mutex<Shown>>);

/// A state and the number of states so far.
struct Shown {
    state: TrayState,
    revision: u32,
}

impl Shared {
    fn new() -> Self {
        Self(Arc::new(Mutex::new(Shown {
            state: TrayState::STARTING,
            revision: 1,
        })))
    }

    pub fn get(&self) -> TrayState {
        self.lock().state
    }

    /// Returns the revision of the menu. Some trays read the menu again only if it has risen.
    pub fn revision(&self) -> u32 {
        self.lock().revision
    }

    fn set(&self, state: TrayState) {
        let mut shown = self.lock();
        shown.state = state;
        shown.revision = shown.revision.wrapping_add(1);
    }

    fn lock(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the name of the icon for a state, as every theme has it.
pub fn name(state: &TrayState) -> &'static str {
    match condition(state) {
        Condition::Armed => "input-keyboard",
        Condition::Paused | Condition::Waiting => "media-playback-pause",
        Condition::Lost => "dialog-warning",
    }
}

/// An icon on the bus.
pub struct Icon {
    connection: Connection,
    state: Shared,
}

impl Icon {
    /// Creates the objects of the icon and of its menu.
    pub fn publish(
        connection: &Connection,
        profiles: Vec<String>,
        commands: CommandSender,
    ) -> zbus::Result<Self> {
        let state = Shared::new();
        let objects = connection.object_server();
        objects.at(ITEM_PATH, Item(state.clone()))?;
        objects.at(MENU_PATH, Menu::new(state.clone(), profiles, commands))?;
        let service = format!("{ITEM}-{}-1", process::id());
        let name = (service.as_str(), DO_NOT_QUEUE);
        connection.call_method(Some(BUS), BUS_PATH, Some(BUS), "RequestName", &name)?;
        Ok(Self {
            connection: connection.clone(),
            state,
        })
    }

    /// Asks the tray to show the icon. Returns `false` if there is none.
    ///
    /// It gets the unique name of the connection: AppIndicator of GNOME may drop an icon whose service has a name of its own.
    pub fn register(&self) -> bool {
        let name = self.connection.unique_name();
        let service = (name.map_or("", |name| name.as_str()),);
        let method = "RegisterStatusNotifierItem";
        self.connection
            .call_method(Some(WATCHER), WATCHER_PATH, Some(WATCHER), method, &service)
            .is_ok()
    }

    /// Shows another state. A bus that has ended is noticed elsewhere.
    pub fn show(&self, state: TrayState) {
        self.state.set(state);
        let emit = |signal: &str| {
            let none = None::<&str>;
            _ = self
                .connection
                .emit_signal(none, ITEM_PATH, ITEM, signal, &());
        };
        emit("NewIcon");
        emit("NewToolTip");
        let status = (status(&state),);
        let none = None::<&str>;
        _ = self
            .connection
            .emit_signal(none, ITEM_PATH, ITEM, "NewStatus", &status);
        Menu::announce(&self.connection, self.state.revision());
    }
}

fn status(state: &TrayState) -> &'static str {
    match condition(state) {
        Condition::Lost => "NeedsAttention",
        _ => "Active",
    }
}

/// The object of the icon.
struct Item(Shared);

#[interface(name = "org.kde.StatusNotifierItem")]
impl Item {
    #[zbus(property)]
    fn category(&self) -> &str {
        "Hardware"
    }

    #[zbus(property)]
    fn id(&self) -> &str {
        "ademan"
    }

    #[zbus(property)]
    fn title(&self) -> &str {
        "Ademán"
    }

    #[zbus(property)]
    fn status(&self) -> &str {
        status(&self.0.get())
    }

    #[zbus(property)]
    fn window_id(&self) -> i32 {
        0
    }

    #[zbus(property)]
    fn icon_name(&self) -> &str {
        name(&self.0.get())
    }

    #[zbus(property)]
    fn attention_icon_name(&self) -> &str {
        name(&self.0.get())
    }

    #[zbus(property)]
    fn tool_tip(&self) -> (String, Vec<Pixmap>, String, String) {
        let state = self.0.get();
        let icon = name(&state).to_owned();
        (
            icon,
            Vec::new(),
            heading(&state).to_owned(),
            sentence(&state),
        )
    }

    #[zbus(property)]
    fn item_is_menu(&self) -> bool {
        true
    }

    #[zbus(property)]
    fn menu(&self) -> ObjectPath<'_> {
        ObjectPath::from_static_str_unchecked(MENU_PATH)
    }
}
