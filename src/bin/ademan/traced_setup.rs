//! The setup of a source whose results are printed or written, and typed into no program.

use ademan::capture::recording::Replay;
use ademan::message::escape_path;
use ademan::output;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, Setup, SetupError};

use crate::failure::Failure;
use crate::session;
use crate::setup_args::SetupArgs;

/// A setup, and the recording that has it.
pub enum TracedSetup {
    /// A setup of the person, or the default one.
    Own(Box<Setup>),
    /// A recording without a setup that replaces its own, and the flags that change it.
    Recorded(Box<Replay>, Box<SetupArgs>),
}

impl TracedSetup {
    /// Reads the setup in a recording that is the only source, unless `file` names another one.
    pub fn open(flags: &SetupArgs, file: Option<&str>) -> Result<Self, Failure> {
        match (flags.recording(), file) {
            (Some(_), None) if flags.names_learned() => Err(Failure::wrong_use(
                "a recording has what the text decoder had learned before; use `--learned` with `--setup` and a setup of your own",
            )),
            (Some(path), None) => {
                let mut replay = Replay::open(path)?;
                if flags.names_role() {
                    replay = replay.without_permissions();
                }
                say!("using the setup in {}", escape_path(path));
                let named = flags.with_trusted_layout()?;
                Ok(Self::Recorded(Box::new(replay), Box::new(named)))
            }
            (_, own) => Ok(Self::Own(Box::new(flags.read_setup(own)?))),
        }
    }

    /// Loads the setup after a change to it.
    pub fn load(&self, change: fn(&mut Setup)) -> Result<LoadedSetup, SetupError> {
        let change = |setup: &mut Setup| {
            // Nothing is typed, so that the results may begin with the first reading.
            setup.arm_immediately = true;
            change(setup);
        };
        match self {
            Self::Own(setup) => {
                let mut setup = (**setup).clone();
                change(&mut setup);
                setup.load_files()
            }
            Self::Recorded(replay, flags) => {
                let settings = flags.replay_settings();
                LoadedSetup::from_changed_recording(replay.setup(), &settings, |setup| {
                    flags.override_permissions(setup);
                    flags.override_decoder(setup);
                    change(setup);
                })
            }
        }
    }

    /// Starts the session of a setup that [`load`](Self::load) has returned. It loses no snapshot, and types nothing.
    pub fn start(self, setup: LoadedSetup) -> Result<SessionHandle, Failure> {
        session::prepare()?;
        let options = SessionOptions {
            output: Some(output::open("none", &setup.required_capabilities())?),
            source: match self {
                Self::Own(_) => None,
                Self::Recorded(replay, _) => Some(replay),
            },
            lossless_snapshots: true,
            ..SessionOptions::default()
        };
        session::start(setup, options)
    }
}
