//! Builds and systems without PulseAudio.

use std::convert::Infallible;

use crate::sound::SoundError;
use crate::sound::click::Click;

/// No server: there is no value of this type.
pub struct SoundServer(Infallible);

impl SoundServer {
    /// Fails.
    pub fn connect() -> Result<Self, SoundError> {
        Err(SoundError::Unsupported(if cfg!(target_os = "linux") {
            "this program was built without them; build it with `--features sound`"
        } else {
            "they need PulseAudio or PipeWire, which Linux has"
        }))
    }

    /// Has no server to play a click on.
    pub fn play(&mut self, _click: Click, _volume: f32) -> Result<(), SoundError> {
        match self.0 {}
    }
}
