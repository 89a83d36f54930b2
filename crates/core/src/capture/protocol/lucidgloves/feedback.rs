//! Messages to a glove: force feedback and haptic pulses.
//!
//! The firmware (`LucidVR/lucidgloves`, `haptics.ino` and `Encoding.ino`) takes a finger that a line does not name as free, so
//! each line names all five. The legacy encoding has the forces of the five fingers with `&` between them, and no pulses
//! (`Encoding/LegacyEncoding.cpp`): such firmware takes a line of the alpha encoding as 0 for the thumb.
//! Only firmware for vibration motors understands a pulse; firmware for servos reads it as a line without fingers, so the line
//! with the forces comes last.

use std::io::Write;

use super::{CURL, FULL_SCALE};
use crate::capture::feedback::{Feedback, FeedbackFormat, Pulse};
use crate::capture::{Channels, Sample};
use crate::hand::Finger;

/// The feedback of the alpha encoding.
pub(super) static ALPHA: FeedbackFormat = FeedbackFormat { curl, encode };

/// The feedback of the legacy encoding.
pub(super) static LEGACY: FeedbackFormat = FeedbackFormat {
    curl,
    encode: encode_legacy,
};

/// The value that holds a finger straight: the servo is at the end of its range.
const FULL_FORCE: f32 = 1000.0;

fn curl(sample: &Sample, finger: Finger) -> Option<f32> {
    let Sample::Channels(channels) = sample else {
        return None;
    };
    let count = *channels.counts.get(CURL + finger.index())?;
    (count != Channels::UNKNOWN).then(|| f32::from(count) / f32::from(FULL_SCALE))
}

/// Writes `F160.00G0.02H1.00` (frequency in hertz, duration in seconds, amplitude) and `A0B700C0D0E0`, each with its line end.
fn encode(feedback: &Feedback, line: &mut Vec<u8>) {
    if let Some(pulse) = feedback.pulse {
        let (frequency_hz, duration_s, amplitude) = match pulse {
            Pulse::Off => (0.0, 0.0, 0.0),
            Pulse::Touch => (160.0, 0.02, 0.4),
            Pulse::Press => (160.0, 0.03, 1.0),
        };
        // A vector takes all bytes.
        let _ = writeln!(line, "F{frequency_hz:.2}G{duration_s:.2}H{amplitude:.2}");
    }
    if let Some(forces) = feedback.forces {
        for (key, force) in (b'A'..).zip(forces) {
            let _ = write!(line, "{}{}", char::from(key), value(force));
        }
        line.push(b'\n');
    }
}

/// Writes `0&700&0&0&0` with its line end.
fn encode_legacy(feedback: &Feedback, line: &mut Vec<u8>) {
    if let Some(forces) = feedback.forces {
        let [thumb, index, middle, ring, little] = forces.map(value);
        let _ = writeln!(line, "{thumb}&{index}&{middle}&{ring}&{little}");
    }
}

fn value(force: f32) -> u16 {
    (force.clamp(0.0, 1.0) * FULL_FORCE).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::protocol::lucidgloves::Fields;

    fn encoded(forces: Option<[f32; 5]>, pulse: Option<Pulse>) -> String {
        let mut line = Vec::new();
        encode(&Feedback { forces, pulse }, &mut line);
        String::from_utf8(line).unwrap()
    }

    #[test]
    fn a_line_names_all_fingers_and_fits_the_buffer_of_the_firmware() {
        let forces = [0.0, 1.0, 0.5, 2.0, f32::NAN];
        assert_eq!(encoded(Some(forces), None), "A0B1000C500D1000E0\n");
        assert_eq!(encoded(Some([0.0; 5]), None), "A0B0C0D0E0\n");
        assert!(encoded(Some([1.0; 5]), None).len() < 100);
        assert_eq!(encoded(None, Some(Pulse::Touch)), "F160.00G0.02H0.40\n");
        assert_eq!(
            encoded(Some([0.25; 5]), Some(Pulse::Off)),
            "F0.00G0.00H0.00\nA250B250C250D250E250\n"
        );
        assert_eq!(encoded(None, None), "");
    }

    #[test]
    fn a_legacy_line_has_five_numbers_and_no_pulse() {
        let mut line = Vec::new();
        let feedback = Feedback {
            forces: Some([0.0, 1.0, 0.5, 2.0, f32::NAN]),
            pulse: Some(Pulse::Press),
        };
        (LEGACY.encode)(&feedback, &mut line);
        assert_eq!(String::from_utf8(line).unwrap(), "0&1000&500&1000&0\n");
    }

    #[test]
    fn the_curl_is_that_of_the_finger() {
        let fields = Fields::parse(b"A0B4095D2048").unwrap();
        let sample = Sample::Channels(fields.channels(FULL_SCALE));
        let fingers = Finger::ALL.iter();
        let curls: Vec<_> = fingers.map(|&finger| curl(&sample, finger)).collect();
        assert_eq!(
            curls,
            [Some(0.0), Some(1.0), None, Some(2048.0 / 4095.0), None]
        );
    }
}
