//! The attacks.

use std::time::Duration;

/// A fault that is caused on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Attack {
    /// Another client grabs the X server.
    GrabServer,
    /// The X server is stopped.
    FreezeServer,
    /// The X server is stopped for little longer than a press may wait.
    DropPresses,
    /// The keymap is replaced by the keymap of another language.
    ChangeKeymap,
    /// Nobody reads the standard error.
    BlockStderr,
    /// Nobody reads the standard output, which has a transcript.
    BlockStdout,
    StopProgram,
    KillProgram,
    /// One SIGTERM.
    TerminateProgram,
    StopWatchdog,
    KillWatchdog,
    UnplugGlove,
    /// Random bytes in place of packets.
    SendJunk,
    SaveLayout,
    SaveInvalidLayout,
    /// The layout file is replaced by a file of another user. Without root, others may write the file.
    SaveForeignLayout,
    PauseByCommand,
    /// SIGUSR1 to the program and its watchdog, as by `pkill`.
    PauseBySignal,
    /// Silent clients, in the number that the control socket accepts.
    ConnectSilentClients,
    /// A client that sends requests and reads no response.
    ConnectFloodingClient,
    /// Clients of the shared hand that send WebSocket frames without a request.
    FloodFrames,
}

/// The part of the system that an attack changes. Attacks of one episode have different targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Display,
    Keymap,
    Stderr,
    Stdout,
    /// The program and its watchdog. Each covers for the other, so only one of them is attacked at a time.
    Processes,
    Glove,
    Layout,
    Pause,
    Clients,
    Viewers,
}

impl Attack {
    pub const ALL: [Self; 21] = [
        Self::GrabServer,
        Self::FreezeServer,
        Self::DropPresses,
        Self::ChangeKeymap,
        Self::BlockStderr,
        Self::BlockStdout,
        Self::StopProgram,
        Self::KillProgram,
        Self::TerminateProgram,
        Self::StopWatchdog,
        Self::KillWatchdog,
        Self::UnplugGlove,
        Self::SendJunk,
        Self::SaveLayout,
        Self::SaveInvalidLayout,
        Self::SaveForeignLayout,
        Self::PauseByCommand,
        Self::PauseBySignal,
        Self::ConnectSilentClients,
        Self::ConnectFloodingClient,
        Self::FloodFrames,
    ];

    pub fn target(self) -> Target {
        match self {
            Self::GrabServer | Self::FreezeServer | Self::DropPresses => Target::Display,
            Self::ChangeKeymap => Target::Keymap,
            Self::BlockStderr => Target::Stderr,
            Self::BlockStdout => Target::Stdout,
            Self::StopProgram
            | Self::KillProgram
            | Self::TerminateProgram
            | Self::StopWatchdog
            | Self::KillWatchdog => Target::Processes,
            Self::UnplugGlove | Self::SendJunk => Target::Glove,
            Self::SaveLayout | Self::SaveInvalidLayout | Self::SaveForeignLayout => Target::Layout,
            Self::PauseByCommand | Self::PauseBySignal => Target::Pause,
            Self::ConnectSilentClients | Self::ConnectFloodingClient => Target::Clients,
            Self::FloodFrames => Target::Viewers,
        }
    }

    /// Returns the shortest and the longest time for which the attack lasts.
    pub fn length(self) -> (Duration, Duration) {
        let milliseconds = match self {
            // A press is dropped after 250 ms.
            Self::DropPresses => (260, 400),
            // Longer than the time-out of the watchdog.
            Self::StopProgram | Self::StopWatchdog => (600, 1_500),
            // This takes long enough for some presses of a typing hand.
            Self::PauseByCommand | Self::PauseBySignal => (1_000, 1_500),
            _ => (100, 1_000),
        };
        let (shortest, longest) = milliseconds;
        (
            Duration::from_millis(shortest),
            Duration::from_millis(longest),
        )
    }

    /// Returns `true` if the attack ends all presses, although the hand still presses.
    pub fn must_release(self) -> bool {
        matches!(
            self,
            Self::StopProgram
                | Self::KillProgram
                | Self::TerminateProgram
                | Self::StopWatchdog
                | Self::KillWatchdog
                | Self::UnplugGlove
                | Self::SendJunk
                | Self::PauseByCommand
                | Self::PauseBySignal
        )
    }

    /// Returns `true` if the X server executes no requests of the program during the attack.
    pub fn blocks_display(self) -> bool {
        self.target() == Target::Display
    }

    /// Returns `true` if the program cannot answer commands during the attack, or exits.
    pub fn silences_program(self) -> bool {
        matches!(
            self,
            Self::StopProgram
                | Self::KillProgram
                | Self::TerminateProgram
                // A second watchdog that is lost within 10 s ends the run.
                | Self::StopWatchdog
                | Self::KillWatchdog
        )
    }
}
