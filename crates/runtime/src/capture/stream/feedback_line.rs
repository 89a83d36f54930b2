//! The writing side of a source.

use std::io::Write;

use crate::capture::feedback::{FeedbackDevice, FeedbackFormat};

/// The feedback over the connection of a source.
#[derive(Default)]
pub struct FeedbackLine {
    device: Option<FeedbackDevice>,
    /// The form that the device reads, as its latest packet shows. It stays after a loss.
    spoken: Option<&'static FeedbackFormat>,
}

impl FeedbackLine {
    /// Returns the device, once it was taken.
    pub fn device(&self) -> Option<&FeedbackDevice> {
        self.device.as_ref()
    }

    /// Switches to the form of feedback that the latest packet shows the device to read.
    pub fn note(&mut self, format: Option<&'static FeedbackFormat>) {
        let Some(format) = format else {
            return;
        };
        if self
            .spoken
            .is_some_and(|spoken| std::ptr::eq(spoken, format))
        {
            return;
        }
        self.spoken = Some(format);
        if let Some(device) = &self.device {
            device.set_format(format);
        }
    }

    /// Creates the device with the writing end of the connection, once. `format` is the form until the device shows another one.
    pub fn take(
        &mut self,
        format: &'static FeedbackFormat,
        writer: impl FnOnce() -> Option<Box<dyn Write + Send>>,
    ) -> Option<FeedbackDevice> {
        if self.device.is_some() {
            return None;
        }
        let device = FeedbackDevice::new(self.spoken.unwrap_or(format));
        device.connect(Some(writer()?));
        Some(self.device.insert(device).clone())
    }
}
