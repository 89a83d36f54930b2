//! The source of a session, on a thread of its own or read by the loop.

use std::thread;
use std::time::Duration;

use crossbeam_channel::TryRecvError;

use crate::capture::{
    CaptureError, CaptureEvent, CaptureThread, InPlaceCapture, Source, spawn_batched,
};
use crate::session::waker::WakeTarget;

/// The source of a session and its events.
pub(super) struct Capture {
    form: CaptureForm,
    packet_period: Option<Duration>,
    is_live: bool,
}

#[expect(
    clippy::large_enum_variant,
    reason = "a session has one, which is not moved"
)]
enum CaptureForm {
    /// The loop polls and reads the source, so that no reading has to pass from one thread to another.
    InPlace(InPlaceCapture),
    /// The source has to block: a recording, merged sources, or a source without a file descriptor.
    Thread(CaptureThread),
}

impl Capture {
    /// Starts to capture. Only the calling thread may [wait](Self::wait).
    pub fn start(source: impl Source + 'static) -> Result<Self, CaptureError> {
        let (packet_period, is_live) = (source.packet_period(), source.is_live());
        let form = match InPlaceCapture::new(Box::new(source)) {
            Ok(capture) => CaptureForm::InPlace(capture),
            Err(source) => CaptureForm::Thread(spawn_batched(source)?),
        };
        Ok(Self {
            form,
            packet_period,
            is_live,
        })
    }

    /// Returns the shortest time between two readings, if the source knows it.
    pub fn packet_period(&self) -> Option<Duration> {
        self.packet_period
    }

    /// Returns `true` if readings arrive at their own pace.
    pub fn is_live(&self) -> bool {
        self.is_live
    }

    /// Removes the oldest event that has arrived. Returns `Disconnected` after the last event of a source on a thread.
    pub fn try_next(&mut self) -> Result<CaptureEvent, TryRecvError> {
        match &mut self.form {
            CaptureForm::InPlace(capture) => capture.next_event().ok_or(TryRecvError::Empty),
            CaptureForm::Thread(capture) => capture.events().try_recv(),
        }
    }

    /// Returns `true` if an event has arrived.
    pub fn has_events(&self) -> bool {
        match &self.form {
            CaptureForm::InPlace(capture) => capture.has_events(),
            CaptureForm::Thread(capture) => !capture.events().is_empty(),
        }
    }

    /// Returns the target that ends a [`wait`](Self::wait).
    pub fn wake_target(&self) -> WakeTarget {
        match &self.form {
            CaptureForm::InPlace(capture) => WakeTarget::Polling(capture.wake_up().clone()),
            CaptureForm::Thread(_) => WakeTarget::Parked(thread::current()),
        }
    }

    /// Waits for events, a wake-up or `timeout`. May return early.
    pub fn wait(&mut self, timeout: Duration) {
        match &mut self.form {
            CaptureForm::InPlace(capture) => capture.wait(timeout),
            CaptureForm::Thread(_) => thread::park_timeout(timeout),
        }
    }

    /// Stops reading. If packets were refused since the latest statistics, the last event has the new statistics. May wait 1 s for a
    /// source on a thread.
    pub fn stop(&mut self) {
        match &mut self.form {
            CaptureForm::InPlace(capture) => capture.stop(),
            CaptureForm::Thread(capture) => capture.stop(),
        }
    }

    /// Reads and queues what has arrived. A source on a thread does so by itself.
    pub fn receive(&mut self) {
        if let CaptureForm::InPlace(capture) = &mut self.form {
            capture.wait(Duration::ZERO);
        }
    }
}
