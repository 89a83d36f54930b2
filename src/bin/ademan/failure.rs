//! Errors for the user: a message and an exit code.

use std::fmt;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use ademan::advice;
use ademan::capture::CaptureError;
use ademan::document::DocumentError;
use ademan::message::escape_path;
use ademan::network::NetworkError;
use ademan::output::OutputError;
use ademan::recorder::RecordError;
use ademan::session::control_socket::ControlError;
use ademan::session::{RequestError, SessionError};
use ademan::setup::SetupError;

/// Exit code of a job that failed.
const JOB: u8 = 1;
/// Exit code for wrong use or an invalid file.
const USE: u8 = 2;
/// Exit code for a damaged recording.
const DAMAGED: u8 = 3;

/// The number of an input or output error on every Unix. The standard library has no kind for it.
const EIO: i32 = 5;

/// Reason why a command failed.
#[derive(Debug)]
pub struct Failure {
    error: anyhow::Error,
    code: u8,
}

impl Failure {
    /// Creates the failure of a job.
    pub fn job(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), JOB)
    }

    /// Creates the failure of a command whose arguments, file or device are unusable.
    pub fn wrong_use(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), USE)
    }

    /// Creates the failure of a file that cannot be read.
    pub fn cannot_read(path: &Path, error: impl fmt::Display) -> Self {
        Self::wrong_use(format!("cannot read {}: {error}", escape_path(path)))
    }

    /// Creates the failure of a new file that cannot be created.
    pub fn cannot_create(path: &Path, error: impl fmt::Display) -> Self {
        Self::wrong_use(format!("cannot create {}: {error}", escape_path(path)))
    }

    /// Creates the failure of a file of the command line that cannot be written.
    pub fn cannot_write(path: &Path, error: impl fmt::Display) -> Self {
        Self::wrong_use(format!("cannot write {}: {error}", escape_path(path)))
    }

    /// Creates the failure of a damaged recording, of which everything before the damage was used.
    pub fn damaged(message: impl Into<String>) -> Self {
        Self::new(anyhow::anyhow!(message.into()), DAMAGED)
    }

    /// Creates the failure of a thread that the operating system refuses to start.
    pub fn no_thread(error: io::Error) -> Self {
        Self::job(advice::no_thread(&error).to_string())
    }

    fn new(error: impl Into<anyhow::Error>, code: u8) -> Self {
        Self {
            error: error.into(),
            code,
        }
    }

    /// Prints the message on standard error. A reader that closed standard output is not a failure.
    pub fn report(self) -> ExitCode {
        if self.is_broken_pipe() {
            return ExitCode::SUCCESS;
        }
        complain!("error: {}", self.message());
        ExitCode::from(self.code)
    }

    /// Returns the text of the error. One of a standard stream names the stream and the remedy; errors of other files name them.
    fn message(&self) -> String {
        use io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull, WouldBlock};
        let error = &self.error;
        let Some(io) = error.downcast_ref::<io::Error>() else {
            return error.to_string();
        };
        match io.kind() {
            StorageFull | QuotaExceeded | FileTooLarge => {
                format!("cannot write to the standard output: {error}")
            }
            WouldBlock => format!(
                "cannot use the standard input or output: {error}; another program has switched it to non-blocking mode: add `| cat`"
            ),
            _ if cfg!(unix) && io.raw_os_error() == Some(EIO) => format!(
                "cannot use the standard input or output: {error}; its terminal was closed, or its disk fails"
            ),
            _ => error.to_string(),
        }
    }

    fn is_broken_pipe(&self) -> bool {
        self.error.chain().any(|cause| {
            let io = cause.downcast_ref::<io::Error>();
            let output = cause.downcast_ref::<OutputError>();
            io.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
                || matches!(output, Some(OutputError::BrokenPipe { .. }))
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.error.fmt(f)
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::new(error, JOB)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
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
            OutputError::Open { .. }
            | OutputError::UnknownOutput(_)
            | OutputError::UnexpectedArgument { .. } => USE,
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

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        let code = match error {
            RecordError::Create { .. } => USE,
            RecordError::Write { .. } => JOB,
        };
        Self::new(error, code)
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

impl From<NetworkError> for Failure {
    fn from(error: NetworkError) -> Self {
        Self::new(error, USE)
    }
}

impl From<RequestError> for Failure {
    fn from(error: RequestError) -> Self {
        Self::new(error, JOB)
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Setup(error) => error.into(),
            SessionError::Capture(error) => error.into(),
            SessionError::Output(error) => error.into(),
            SessionError::Control(error) => error.into(),
            SessionError::Record(error) => error.into(),
            SessionError::Thread(_) => Self::new(error, JOB),
            SessionError::NoSource | SessionError::PanicKeys(_) | SessionError::Share(_) => {
                Self::new(error, USE)
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    #[test]
    fn an_error_of_a_standard_stream_names_the_stream_and_the_remedy() {
        // A benchmark that includes this file has no tests, so an import outside would be unused there.
        use super::*;

        let message = |error: io::Error| Failure::from(error).message();
        let full = message(io::ErrorKind::StorageFull.into());
        let writing = "cannot write to the standard output: ";
        assert!(full.starts_with(writing), "{full}");
        let using = "cannot use the standard input or output: ";
        let busy = message(io::ErrorKind::WouldBlock.into());
        assert!(busy.starts_with(using) && busy.ends_with("add `| cat`"));
        let closed = message(io::Error::from_raw_os_error(EIO));
        assert!(closed.starts_with(using), "{closed}");
        assert!(closed.contains("its terminal was closed"), "{closed}");
        let other = message(io::Error::other("no such page"));
        assert_eq!(other, "no such page");
        let file = Failure::cannot_read(Path::new("a.ron"), io::Error::from_raw_os_error(EIO));
        assert!(file.message().starts_with("cannot read a.ron: "));
    }
}
