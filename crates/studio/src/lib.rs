//! Studio: one window that shows a session: the hand over its boards, its sensors, and time plots.
//!
//! Studio receives [`Snapshot`](ademan_core::snapshot::Snapshot)s and [`View`](ademan_runtime::session::view::View)s, and sends
//! [`Command`](ademan_core::command::Command)s and, through a [`SensorLink`](ademan_runtime::session::SensorLink), other
//! calibrations. It shares nothing else with a session: both channels drop what a slow window does not receive, so that
//! typing does not depend on it.
//!
//! ```text
//!  session ─ snapshots, views ──▶ StudioModel ──▶ panels (egui) ─ Command ──▶ session
//!                                     └──▶ scene, camera ──▶ Picture ──▶ panels/space
//! ```
//!
//! Only `app`, `fonts`, the window of the overlay and the files of `panels` name egui. All else is computed without a window:
//!
//! - [`model`] is the latest state of the session, [`attached`] a session in another program. [`latency`], [`history`], [`plot`],
//!   [`filter_trace`], [`trails`] and [`sensors`] are figures of it, and [`notices`] its messages.
//! - [`scene`] draws hands and boards, from a [`camera`], into a [`picture`]; [`shapes`] are its meshes, [`marks`] the marks on controls,
//!   [`pose_picture`] a calibration pose, [`overlay`] a view over other programs. [`pace`] is the time between two frames.
//! - [`canvas`] and [`editor`] edit a layout: the picture of a board, and its text. [`lab`] scores it, and [`fingertip`] tries it with the
//!   mouse.
//! - [`glove_editor`], [`glove_file`], [`guide`] and [`sensor_control`] calibrate a glove.
//! - [`playback`] plays recordings. [`simulated`] is the simulated hand, and [`headset`] the link for a headset.
//! - [`first_start`] and [`tour`] lead through the first start. [`typing`] tells whether other programs are typed into, [`sound`] plays
//!   clicks.
//! - [`settings`], [`settings_file`] and [`recent`] are what is remembered, [`setup_change`] changes the setup, and [`texts`] are the words
//!   on the screen.
//!
//! # Adding a panel
//!
//! 1. What it shows: a file beside this one, without egui, with unit tests.
//! 2. How it is drawn: a file in `panels`, with a function that receives a `&mut Ui`, the `PanelState` and the `PanelContext`.
//! 3. An entry in the table of `panels/table.rs`: its place, when it is shown, and that function. F6 reaches it, its size is kept.
//! 4. Its keys: actions in the table of `panels/actions.rs`, which the toolbar and the list of keys show.
//! 5. Its name and words: in `texts/en.ftl` and `texts/es.ftl`; see [`texts`].

mod app;
pub mod attached;
mod error;
pub mod camera;
pub mod canvas;
mod disk_search;
pub mod editor;
pub mod filter_trace;
pub mod fingertip;
pub mod first_start;
mod fonts;
pub mod glove_editor;
pub mod glove_file;
mod graphics;
pub mod guide;
pub mod headset;
pub mod history;
mod joint_names;
pub mod lab;
pub mod latency;
pub mod marks;
mod missed;
pub mod model;
pub mod notices;
pub mod overlay;
pub mod pace;
mod panels;
pub mod picture;
pub mod playback;
pub mod plot;
pub mod pose_picture;
pub mod recent;
mod recordings;
pub mod scene;
pub mod sensor_control;
pub mod sensors;
pub mod settings;
pub mod settings_file;
pub mod setup_change;
pub mod shapes;
pub mod simulated;
pub mod sound;
pub mod texts;
pub mod tour;
pub mod trails;
pub mod typing;

pub use self::app::{SessionRequest, StudioApp, StudioStart, open_window};
pub use self::error::StudioError;
pub use self::overlay::window::{Overlay, open_overlay};
pub use self::panels::PictureFormats;
