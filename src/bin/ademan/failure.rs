//! Errors as the user meets them: a message, and an exit code.

use std::process::ExitCode;

use ademan::capture::CaptureError;
use ademan::document::DocumentError;
use ademan::output::OutputError;
use ademan::session::SessionError;
use ademan::session::control_socket::ControlError;
use ademan::session::panic_keys::PanicKeysError;
use ademan::setup::SetupError;

/// The exit code for a job that failed.
const JOB: u8 = 1;
/// The exit code for wrong use or a bad file.
const USE: u8 = 2;
/// The exit code for a recording that is damaged.
const DAMAGED: u8 = 3;

/// Why a command did not do its job.
#[derive(Debug)]
pub struct Failure {
    error: anyhow::Error,
    code: u8,
}

impl Failure {
    /// The job failed.
    pub fn job(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), JOB)
    }

    /// Wrong use, or a file or device that is not as it should be.
    pub fn wrong_use(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), USE)
    }

    /// What was played is damaged; all that could be used of it was.
    pub fn damaged(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), DAMAGED)
    }

    fn new(error: impl Into<anyhow::Error>, code: u8) -> Self {
        Self {
            error: error.into(),
            code,
        }
    }

    /// Says it on standard error; a reader that went away is no failure.
    pub fn report(self) -> ExitCode {
        if self.is_broken_pipe() {
            return ExitCode::SUCCESS;
        }
        say!("error: {}", self.error);
        ExitCode::from(self.code)
    }

    fn is_broken_pipe(&self) -> bool {
        self.error.chain().any(|cause| {
            let io = cause.downcast_ref::<std::io::Error>();
            let output = cause.downcast_ref::<OutputError>();
            io.is_some_and(|error| error.kind() == std::io::ErrorKind::BrokenPipe)
                || matches!(output, Some(OutputError::BrokenPipe { .. }))
        })
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::new(error, JOB)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Self::new(error, JOB)
    }
}

impl From<DocumentError> for Failure {
    fn from(error: DocumentError) -> Self {
        Self::new(error, USE)
    }
}

impl From<CaptureError> for Failure {
    fn from(error: CaptureError) -> Self {
        let code = match error {
            CaptureError::InvalidUri { .. } | CaptureError::Open { .. } => USE,
            CaptureError::Malformed { .. } => DAMAGED,
            _ => JOB,
        };
        Self::new(error, code)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        let code = match error {
            OutputError::Open { .. } | OutputError::UnknownOutput(_) => USE,
            _ => JOB,
        };
        Self::new(error, code)
    }
}

impl From<ControlError> for Failure {
    fn from(error: ControlError) -> Self {
        let code = match error {
            ControlError::NoResponse { .. } => JOB,
            _ => USE,
        };
        Self::new(error, code)
    }
}

impl From<PanicKeysError> for Failure {
    fn from(error: PanicKeysError) -> Self {
        Self::new(error, USE)
    }
}

impl From<SetupError> for Failure {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::Capture(error) => error.into(),
            error => Self::new(error, USE),
        }
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Capture(error) => error.into(),
            SessionError::Output(error) => error.into(),
        }
    }
}
