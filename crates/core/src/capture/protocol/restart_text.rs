//! Detection of a restarted board by the text that it prints.

/// Shortest line of text, in printable characters before a line end. Broken packets seldom contain a longer run.
const MIN_LINE_LENGTH: u8 = 8;

/// Detector of a line of text among the bytes that belong to no packet.
#[derive(Clone, Debug, Default)]
pub(super) struct RestartTextDetector {
    /// Length of the current run of printable characters.
    printable: u8,
    /// `true` after a packet: text before the first packet is a normal start.
    has_packet: bool,
    has_text: bool,
}

impl RestartTextDetector {
    /// Handles a byte that belongs to no packet.
    pub fn push_byte(&mut self, byte: u8) {
        match byte {
            b' '..=b'~' => self.printable = self.printable.saturating_add(1),
            b'\r' | b'\n' if self.printable >= MIN_LINE_LENGTH && self.has_packet => {
                self.has_text = true;
                // Further lines belong to the same restart.
                self.has_packet = false;
            }
            _ => self.printable = 0,
        }
    }

    /// Handles a packet.
    pub fn push_packet(&mut self) {
        self.printable = 0;
        self.has_packet = true;
    }

    /// Returns `true` once after each line of text that followed a packet.
    pub fn take(&mut self) -> bool {
        std::mem::take(&mut self.has_text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_text_after_a_packet_are_one_restart() {
        let table: [(&[u8], bool); 6] = [
            (b"BUFFALO 3.4 (ext)\r\n", true),
            (b"Ready...\n", true),
            (b"Ready..\n", false),
            (b"no end of a line", false),
            (b"cut\x06here\r\n", false),
            (b"noise\xff\x00Glove v2\r", true),
        ];
        for (bytes, is_text) in table {
            let mut detector = RestartTextDetector::default();
            bytes.iter().for_each(|&byte| detector.push_byte(byte));
            assert!(!detector.take(), "text before the first packet is a start");
            detector.push_packet();
            for _ in 0..2 {
                bytes.iter().for_each(|&byte| detector.push_byte(byte));
            }
            assert_eq!(detector.take(), is_text, "{bytes:?}");
            assert!(!detector.take());
        }
    }
}
