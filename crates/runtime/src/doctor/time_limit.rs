//! A time limit for the probes of other programs, which may be stopped or hang.

use std::thread;
use std::time::Duration;

use crossbeam_channel::bounded;

use crate::advice;

/// Returns the result of `probe`, or the message about `program` and the remedy if there is none within `limit`. The probe runs on a thread
/// of its own, as a connection to a program that hangs has no time limit.
pub(super) fn probe_within<T: Send + 'static>(
    limit: Duration,
    program: &str,
    remedy: &str,
    probe: impl FnOnce() -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let (probed, result) = bounded(1);
    let thread = thread::Builder::new().name("probe".into());
    let run = move || _ = probed.send(probe());
    thread
        .spawn(run)
        .map_err(|error| advice::no_thread(&error).to_string())?;
    result.recv_timeout(limit).unwrap_or_else(|_| {
        let seconds = limit.as_secs();
        Err(format!(
            "{program} does not answer within {seconds} s: it is stopped or hangs; {remedy}"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_that_hangs_is_an_error_with_a_remedy() {
        let (end, ended) = bounded::<()>(0);
        let hanging = move || {
            let _ = ended.recv();
            Ok(())
        };
        let probed = probe_within(Duration::ZERO, "the runtime", "start it again", hanging);
        drop(end);
        let expected =
            "the runtime does not answer within 0 s: it is stopped or hangs; start it again";
        assert_eq!(probed, Err(expected.to_owned()));
    }

    #[test]
    fn a_probe_that_answers_has_its_own_result() {
        let limit = Duration::from_secs(60);
        assert_eq!(probe_within(limit, "", "", || Ok(7)), Ok(7));
        let refused = probe_within::<()>(limit, "", "", || Err("no headset".into()));
        assert_eq!(refused, Err("no headset".into()));
    }
}
