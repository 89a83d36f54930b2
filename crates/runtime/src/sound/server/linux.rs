//! PulseAudio and PipeWire, through the protocol of PulseAudio.
//!
//! The clicks are uploaded once, as sounds of events are; a press then costs one short message. No stream is open between clicks, so
//! that the sound device may sleep.

use std::ffi::CString;
use std::fs;
use std::io::BufReader;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use pulseaudio::protocol::{
    self, AuthParams, AuthReply, ChannelMap, Command, CommandReply, CreateUploadStreamReply,
    LookupReply, MAX_VERSION, PlaySampleParams, Prop, Props, ProtocolError, SampleFormat,
    SampleSpec, SetClientNameReply, UploadStreamParams,
};

use crate::sound::SoundError;
use crate::sound::click::Click;
use crate::sound::waveform::{self, SAMPLE_RATE};
use ademan_core::message::escape_path;

/// Longest wait for an answer of the server.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Length of the cookie of the protocol.
const COOKIE_BYTES: usize = 256;

/// A connection to the server, which has the clicks.
pub struct SoundServer {
    stream: BufReader<UnixStream>,
    version: u16,
    sequence: u32,
}

impl SoundServer {
    /// Connects to the server of this person and uploads the clicks.
    pub fn connect() -> Result<Self, SoundError> {
        let path = pulseaudio::socket_path_from_env().ok_or_else(|| {
            SoundError::NoServer(
                "there is no sound server at $XDG_RUNTIME_DIR/pulse/native".to_owned(),
            )
        })?;
        let opened = UnixStream::connect(&path).and_then(|stream| {
            stream.set_read_timeout(Some(TIMEOUT))?;
            stream.set_write_timeout(Some(TIMEOUT))?;
            Ok(stream)
        });
        let stream = opened.map_err(|error| {
            SoundError::NoServer(format!("{error} at {path}", path = escape_path(&path)))
        })?;
        let mut server = Self {
            stream: BufReader::new(stream),
            version: MAX_VERSION,
            sequence: 0,
        };
        let ready = server.log_in().and_then(|()| {
            let mut clicks = Click::ALL.iter();
            clicks.try_for_each(|&click| server.upload(click))
        });
        ready.map_err(refused)?;
        Ok(server)
    }

    /// Starts a click. `volume` is a fraction of the full volume, on the scale that volume controls have.
    pub fn play(&mut self, click: Click, volume: f32) -> Result<(), SoundError> {
        let full = protocol::Volume::NORM.as_u32();
        let command = Command::PlaySample(PlaySampleParams {
            sink_index: None,
            sink_name: None,
            volume: (full as f32 * volume) as u32,
            name: sample_name(click),
            props: event_props(),
        });
        // The reply is the index of the stream that plays the click, in the form of a look-up.
        let reply = self.ask::<LookupReply>(&command);
        reply.map(drop).map_err(refused)
    }

    fn log_in(&mut self) -> Result<(), ProtocolError> {
        let cookie = pulseaudio::cookie_path_from_env().and_then(|path| fs::read(path).ok());
        // A server that knows this person by the socket needs no cookie, but one of the full length.
        let mut cookie = cookie.unwrap_or_default();
        cookie.resize(COOKIE_BYTES, 0);
        let reply: AuthReply = self.ask(&Command::Auth(AuthParams {
            version: MAX_VERSION,
            supports_shm: false,
            supports_memfd: false,
            cookie,
        }))?;
        self.version = reply.version.min(MAX_VERSION);
        let mut props = Props::new();
        props.set(Prop::ApplicationName, c"Adem\xc3\xa1n");
        self.ask::<SetClientNameReply>(&Command::SetClientName(props))?;
        Ok(())
    }

    /// Uploads a click. One of the same name, of another run, is the same.
    fn upload(&mut self, click: Click) -> Result<(), ProtocolError> {
        let samples = waveform::samples(click);
        let bytes: Vec<u8> = samples.iter().flat_map(|it| it.to_le_bytes()).collect();
        let created: CreateUploadStreamReply =
            self.ask(&Command::CreateUploadStream(UploadStreamParams {
                media_name: Some(sample_name(click)),
                sample_spec: SampleSpec {
                    format: SampleFormat::S16Le,
                    channels: 1,
                    sample_rate: SAMPLE_RATE,
                },
                channel_map: ChannelMap::mono(),
                length: bytes.len() as u32,
                props: event_props(),
            }))?;
        protocol::write_memblock(self.stream.get_mut(), created.channel, &bytes, 0)?;
        self.send(&Command::FinishUploadStream(created.channel))?;
        protocol::read_ack_message(&mut self.stream).map(drop)
    }

    fn ask<R: CommandReply>(&mut self, command: &Command) -> Result<R, ProtocolError> {
        self.send(command)?;
        let (_, reply) = protocol::read_reply_message(&mut self.stream, self.version)?;
        Ok(reply)
    }

    fn send(&mut self, command: &Command) -> Result<(), ProtocolError> {
        self.sequence += 1;
        let stream = self.stream.get_mut();
        protocol::write_command_message(stream, self.sequence, command, self.version)
    }
}

fn sample_name(click: Click) -> CString {
    let name = format!("ademan-click-{click}");
    CString::new(name).expect("the names of clicks have no NUL")
}

/// Returns the properties of a sound of an event, whose volume a desktop sets apart from the volume of music.
fn event_props() -> Props {
    let mut props = Props::new();
    props.set(Prop::MediaRole, c"event");
    props
}

fn refused(error: ProtocolError) -> SoundError {
    match error {
        ProtocolError::ServerError(error) => SoundError::Refused(error.to_string()),
        error => SoundError::NoServer(error.to_string()),
    }
}
