//! Tells a board that has started anew from a line that is disturbed: the board says something in words.

/// So many printable characters and the end of a line are text. Shorter ones are missed; more are seldom among
/// the bytes of a broken frame.
const SHORTEST_LINE: u8 = 8;

/// Looks for a line of text among the bytes that belong to no frame.
#[derive(Clone, Debug, Default)]
pub(in crate::capture) struct TextDetector {
    /// Printable characters in a row, up to now.
    printable: u8,
    has_seen_frame: bool,
    has_text: bool,
}

impl TextDetector {
    /// Takes a byte that belongs to no frame.
    pub fn see_byte(&mut self, byte: u8) {
        match byte {
            b' '..=b'~' => self.printable = self.printable.saturating_add(1),
            b'\r' | b'\n' if self.printable >= SHORTEST_LINE && self.has_seen_frame => {
                self.has_text = true;
                // Noise that goes on is no second start.
                self.has_seen_frame = false;
            }
            _ => self.printable = 0,
        }
    }

    /// Takes note of a frame.
    pub fn see_frame(&mut self) {
        self.printable = 0;
        self.has_seen_frame = true;
    }

    /// Whether there was text since the last call.
    pub fn take(&mut self) -> bool {
        std::mem::take(&mut self.has_text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_text_after_a_frame_is_one_start() {
        let table: [(&[u8], bool); 6] = [
            (b"BUFFALO 3.4 (ext)\r\n", true),
            (b"Ready...\n", true),
            (b"Ready..\n", false),
            (b"no end of a line", false),
            (b"cut\x06here\r\n", false),
            (b"noise\xff\x00Glove v2\r", true),
        ];
        for (bytes, is_text) in table {
            let mut watch = TextDetector::default();
            bytes.iter().for_each(|&byte| watch.see_byte(byte));
            assert!(
                !watch.take(),
                "before the first frame it is the first start"
            );
            watch.see_frame();
            for _ in 0..2 {
                bytes.iter().for_each(|&byte| watch.see_byte(byte));
            }
            assert_eq!(watch.take(), is_text, "{bytes:?}");
            assert!(!watch.take());
        }
    }
}
