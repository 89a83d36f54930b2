//! The window: receives what the session shows, and lays out the panels.

mod start;
mod window;

use std::path::{Path, PathBuf};
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError};
use eframe::egui;

pub use self::start::{SessionRequest, StudioStart};
pub use self::window::open_window;
use self::window::place_of_window;
pub(crate) use self::window::{run_window, window_options};
use crate::attached::Attached;
use crate::error::StudioError;
use crate::fingertip::Fingertip;
use crate::fonts::fonts;
use crate::headset::HeadsetLink;
use crate::lab::WatchedPerson;
use crate::model::StudioModel;
use crate::panels::{self, PanelContext, PanelState, PictureFormats, WatchChange};
use crate::playback::Player;
use crate::sensor_control::SensorControl;
use crate::settings::Settings;
use crate::settings_file::SettingsFile;
use crate::shapes::Shapes;
use crate::simulated::HandControl;
use crate::sound::Sound;
use ademan_core::command::Command;
use ademan_core::document::{Document, DocumentError};
use ademan_core::snapshot::Snapshot;
use ademan_runtime::session::view::Viewer;
use ademan_runtime::session::{CommandSender, LayoutTrial, SessionHandle};

/// Longest time between the clicks of a double click, in seconds: as on most desktops, and two frames of a slow machine.
const DOUBLE_CLICK_S: f64 = 0.5;

/// The program in the window.
pub struct StudioApp {
    model: StudioModel,
    snapshots: Receiver<Snapshot>,
    viewer: Viewer,
    commands: CommandSender,
    trial: Option<LayoutTrial>,
    /// The recording that is shown in place of the session.
    player: Option<Player>,
    /// The session in another program that is shown in place of the session.
    attached: Option<Attached>,
    /// The person of the lab who is shown while the session continues.
    watching: Option<Watching>,
    /// The session whose hand follows the mouse.
    fingertip: Option<Fingertip>,
    /// The simulated hand that is the source of the session.
    hand: Option<HandControl>,
    /// Another setup can be opened in a session of its own.
    can_open: bool,
    pictures: Option<PictureFormats>,
    sensors: SensorControl,
    panels: PanelState,
    settings_file: SettingsFile,
    /// Clicks on presses; without it Studio is silent.
    sound: Option<Sound>,
    /// `true` if the last frame differed from the frame before it, even without input.
    has_changed: bool,
}

/// A person of the lab who is watched.
struct Watching {
    // First, so that the recording of the person is removed after it was closed.
    player: Player,
    model: StudioModel,
    person: WatchedPerson,
}

impl Watching {
    fn new((person, player): (WatchedPerson, Player)) -> Self {
        Self {
            model: player.recording().first_model(),
            player,
            person,
        }
    }
}

impl StudioApp {
    /// Creates the program for a session.
    pub fn new(session: &SessionHandle) -> Result<Self, StudioError> {
        let viewer = session.add_viewer();
        let view = viewer.views().recv().map_err(|_| StudioError::Ended)?;
        let sensors = SensorControl::new(session.sensors());
        let shapes = Shapes::for_setup(sensors.setup());
        Ok(Self {
            model: StudioModel::with_shapes(view, sensors.table(), shapes),
            snapshots: session.snapshots().clone(),
            viewer,
            commands: session.commands().clone(),
            trial: session.layout_trial().cloned(),
            player: None,
            attached: None,
            watching: None,
            fingertip: None,
            hand: None,
            can_open: false,
            pictures: None,
            sensors,
            panels: PanelState::default(),
            settings_file: SettingsFile::default(),
            sound: None,
            has_changed: true,
        })
    }

    /// Restores the settings of a file, and writes them there when they change. Without this, nothing is remembered.
    #[must_use]
    pub fn with_settings(mut self, path: PathBuf) -> Self {
        let (file, settings, error) = SettingsFile::open(path);
        self.panels.restore(settings);
        self.settings_file = file;
        self.panels.message = error.map(|error| error.to_string());
        let setup = self.sensors.setup();
        if let Some(own) = setup.layout_path(&setup.layout) {
            self.panels.settings().recent_layouts.push(Path::new(own));
        }
        self
    }

    /// Changes the simulated hand of the session as the settings say, which are restored before. A person of the setup comes first; the
    /// file of the settings keeps the other one, and one who cannot be simulated in this session.
    #[must_use]
    pub fn with_hand(mut self, mut hand: HandControl) -> Self {
        let wanted = &mut self.panels.settings().hand;
        if hand.has_own_person() {
            self.panels.replaced_person = wanted.person.take();
        } else if let Err(error) = hand.apply(wanted) {
            self.panels.replaced_person = wanted.person.take();
            self.panels.message = Some(error.to_string());
        }
        self.hand = Some(hand);
        self
    }

    /// Clicks on presses of the session, as the settings say. Without this, Studio is silent.
    #[must_use]
    pub fn with_sound(mut self, session: &SessionHandle) -> Self {
        match Sound::start(self.snapshots.clone(), session.add_viewer()) {
            Ok((sound, snapshots)) => {
                self.snapshots = snapshots;
                self.sound = Some(sound);
            }
            Err(error) => self.panels.message = Some(format!("no clicks are heard: {error}")),
        }
        self
    }

    /// Exports layouts in more formats than SVG.
    #[must_use]
    pub fn with_pictures(mut self, pictures: PictureFormats) -> Self {
        self.pictures = Some(pictures);
        self
    }

    /// Returns the settings, which are written when they change: by panels and by other windows of Studio.
    pub fn settings(&mut self) -> &mut Settings {
        self.panels.settings()
    }

    /// Prepares a window for the first frame.
    pub fn prepare(context: &egui::Context) {
        context.set_fonts(fonts());
        context.options_mut(|options| {
            options.input_options.max_double_click_delay = DOUBLE_CLICK_S;
        });
    }

    /// The state that the window shows.
    pub fn model(&self) -> &StudioModel {
        self.fingertip
            .as_ref()
            .map_or(&self.model, |fingertip| &fingertip.model)
    }

    /// Shows a recording in place of what the session sends.
    #[must_use]
    pub fn with_player(mut self, player: Player) -> Self {
        self.player = Some(player);
        self.trial = None;
        self.sensors.lock();
        self
    }

    /// Shows a session in another program in place of this one, and sends commands there.
    ///
    /// # Errors
    /// If that session has ended.
    pub fn with_attached(mut self, attached: Attached) -> Result<Self, StudioError> {
        self.model = attached.first_model()?;
        self.attached = Some(attached);
        self.trial = None;
        self.sensors.lock();
        Ok(self)
    }

    /// Shows a link for a headset until one is connected, and the buttons that let it press keys.
    #[must_use]
    pub fn with_headset(mut self, link: Option<HeadsetLink>) -> Self {
        self.panels.show_headset_link(link);
        self
    }

    /// Shows the reason why a change of the setup does not apply and the previous setup stays in use.
    #[must_use]
    pub fn with_refusal(mut self, reason: String) -> Self {
        self.panels.refuse(reason);
        self
    }

    /// Draws the limbs of an arm file, if it has any, in place of skin.
    #[must_use]
    pub fn with_arm(mut self, document: Option<&Document>) -> Self {
        if let Some(document) = document {
            self.model.shapes.set_arm(document);
        }
        self
    }

    /// Opens a layout in the editor in place of the session's layout. A layout that comes with the program is an unsaved copy.
    pub fn edit(&mut self, name: &str) -> Result<(), DocumentError> {
        self.panels.edit(name, self.model.view.layout.fit)
    }

    /// Draws one frame.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let elapsed = Duration::from_secs_f32(ui.input(|input| input.unstable_dt));
        self.advance(elapsed);
        let (mut sent, mut moves, mut watch) = (Vec::new(), Vec::new(), None);
        let watching = self.watching.as_ref();
        let (shown, aim) = match &mut self.fingertip {
            Some(fingertip) => (Some(&fingertip.model), Some(&mut fingertip.aim)),
            None => (watching.map(|it| &it.model), None),
        };
        let mut context = PanelContext {
            model: shown.unwrap_or(&self.model),
            session: &self.model,
            is_replay: self.player.is_some(),
            attached: self.attached.as_ref(),
            has_hand: self.hand.is_some(),
            can_open: self.can_open,
            pictures: self.pictures,
            sensors: &mut self.sensors,
            trial: self.trial.as_ref(),
            sent: &mut sent,
            player: watching.map(|it| &it.player).or(self.player.as_ref()),
            watched: watching.map(|it| &it.person),
            fingertip: aim,
            watch: &mut watch,
            moves: &mut moves,
        };
        panels::show(ui, &mut self.panels, &mut context);
        self.sensors.advance(elapsed, &mut self.model.sensors);
        if let Some(fingertip) = &mut self.fingertip {
            fingertip.aim.end_picture();
        }
        for command in sent {
            match (&self.fingertip, &command) {
                (Some(fingertip), Command::Candidate { .. }) => fingertip.send(command),
                _ => self.send(command),
            }
        }
        let watched = self.watching.as_mut().map(|it| &mut it.player);
        if let Some(player) = watched.or(self.player.as_mut()) {
            moves.into_iter().for_each(|change| player.apply(change));
        }
        match watch {
            Some(WatchChange::Start(started)) => self.watching = Some(Watching::new(*started)),
            Some(WatchChange::End) => self.watching = None,
            None => {}
        }
        self.apply_sound();
        self.apply_hand();
    }

    /// Updates the shown state to the present.
    fn advance(&mut self, elapsed: Duration) {
        self.has_changed = match &mut self.player {
            Some(player) => {
                player.advance(elapsed, &mut self.model);
                player.is_playing() || !player.is_complete()
            }
            None => self.receive(),
        };
        if let Some(watching) = &mut self.watching {
            watching.player.advance(elapsed, &mut watching.model);
            self.has_changed |= watching.player.is_playing() || !watching.player.is_complete();
        }
        self.has_changed |= self.panels.is_busy();
        self.advance_fingertip();
    }

    /// Starts and ends the session whose hand follows the mouse. Another layout has another session, with a finger that is up.
    fn advance_fingertip(&mut self) {
        let layout = &self.model.view.layout;
        let is_wanted = self.panels.is_fingertip && self.player.is_none();
        self.panels.is_fingertip = is_wanted && self.watching.is_none() && !self.model.has_ended;
        if !self.panels.is_fingertip {
            self.fingertip = None;
            return;
        }
        if !self.fingertip.as_ref().is_some_and(|it| it.is_for(layout)) {
            self.fingertip = None;
            match Fingertip::start(self.sensors.setup(), layout) {
                Ok(fingertip) => self.fingertip = Some(fingertip),
                Err(error) => self.panels.message = Some(error.to_string()),
            }
        }
        if let Some(fingertip) = &mut self.fingertip {
            fingertip.receive();
            self.has_changed = true;
        }
        // A key of the layout may end the session.
        if let Some(ended) = self.fingertip.take_if(|it| it.model.has_ended) {
            self.panels.message = ended.end().err().map(|error| error.to_string());
        }
        self.panels.is_fingertip = self.fingertip.is_some();
    }

    /// Changes the simulated hand, and takes back a person that cannot be simulated.
    fn apply_hand(&mut self) {
        let wanted = &mut self.panels.settings().hand;
        let Some(hand) = &mut self.hand else {
            return;
        };
        if let Err(error) = hand.apply(wanted) {
            wanted.person.clone_from(&hand.applied().person);
            self.panels.message = Some(error.to_string());
        }
    }

    fn apply_sound(&mut self) {
        let Some(sound) = &mut self.sound else {
            return;
        };
        let message = |checked: &Sound| checked.error().map(ToString::to_string);
        let before = message(sound);
        sound.apply(self.panels.settings().sound);
        let now = message(sound);
        // A later message of something else stays.
        if now != before && (now.is_some() || self.panels.message == before) {
            self.panels.message = now;
        }
    }

    /// Receives what the session has sent since the last frame. Does not wait. Returns `false` if that is nothing.
    fn receive(&mut self) -> bool {
        if let Some(attached) = &self.attached {
            self.panels.message = attached.next_reason().or(self.panels.message.take());
            return attached.update(&mut self.model);
        }
        let mut has_received = false;
        // One that arrives during the loop may follow dropped ones, which only a later view replaces.
        let waiting = self.snapshots.len();
        for snapshot in self.snapshots.try_iter().take(waiting) {
            self.model.update(&snapshot);
            self.sensors.update(&snapshot);
            has_received = true;
        }
        match self.viewer.views().try_recv() {
            Ok(view) => {
                self.model.set_view(view);
                has_received = true;
            }
            Err(TryRecvError::Disconnected) => self.model.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
        has_received
    }

    /// Remembers the place of the window, and writes the settings every few seconds or, at the end, at once.
    fn save_settings(&mut self, context: &egui::Context, is_end: bool) {
        let settings = self.panels.settings();
        settings.window = place_of_window(context).or(settings.window);
        let kept = self.kept_settings();
        let saved = if is_end {
            self.settings_file.save(&kept)
        } else {
            let now = context.input(|input| input.time);
            self.settings_file.save_at(now, &kept)
        };
        if let Err(error) = saved {
            self.panels.message = Some(error.to_string());
        }
    }

    /// Returns the settings for the file: with the person that the session replaces, until another one is chosen.
    fn kept_settings(&mut self) -> Settings {
        let mut kept = self.panels.settings().clone();
        let replaced = &mut self.panels.replaced_person;
        if kept.hand.person.is_some() {
            *replaced = None;
        } else {
            kept.hand.person.clone_from(replaced);
        }
        kept
    }

    fn send(&mut self, command: Command) {
        let sent = match &self.attached {
            Some(attached) => attached.send(command),
            None => self.commands.send(command),
        };
        if let Err(error) = sent {
            self.panels.message = Some(error.to_string());
        }
    }
}
