//! Virtual ports of the ALSA sequencer and of CoreMIDI.

use std::io;

use midir::MidiOutput;
use midir::os::unix::VirtualOutput;

use crate::output::midi::thread::Writer;

/// The name of the client and of its port, as `aconnect -l` lists them.
const NAME: &str = "Ademan";

/// Creates a virtual port. The error states the cause and the remedy.
pub fn open() -> Result<Writer, String> {
    let cannot = |error: &dyn std::fmt::Display| {
        format!(
            "cannot create a MIDI port: {error}; on Linux load the ALSA sequencer with `sudo modprobe snd-seq`, or name a raw \
             device: midi:/dev/snd/midiC1D0"
        )
    };
    let output = MidiOutput::new(NAME).map_err(|error| cannot(&error))?;
    let mut port = output
        .create_virtual(NAME)
        .map_err(|error| cannot(&error))?;
    tracing::info!("the MIDI port is {NAME}: `aconnect -l` lists it");
    Ok(Box::new(move |message| {
        port.send(message).map_err(io::Error::other)?;
        Ok(message.len())
    }))
}
