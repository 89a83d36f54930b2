//! Seeded random inputs: valid ones with damage, and noise.

/// Limits of ranges and syntax of the formats.
const TOKENS: &[&str] = &[
    "NaN",
    "inf",
    "-inf",
    "1e308",
    "-1",
    "0",
    "-0.0",
    "1e-320",
    "4294967296",
    "18446744073709551616",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    "\"",
    "'",
    "\\",
    "Some(",
    "None",
    "//",
    "/*",
    "#",
    "&",
    ";",
    "?",
    "=",
    "%00",
    "\0",
    "\u{feff}",
    "\r\n",
    "é",
    "😀",
    "true",
    "null",
    "r#\"",
    "\"a\"",
    "999999999",
    "((((((((((((((((",
    "[[[[[[[[[[[[[[[[",
    "{\"ask\":",
];

/// Inputs for one target.
pub struct Inputs {
    random: fastrand::Rng,
    seeds: Vec<Vec<u8>>,
}

impl Inputs {
    pub fn new(seed: u64, seeds: Vec<Vec<u8>>) -> Self {
        assert!(!seeds.is_empty());
        Self {
            random: fastrand::Rng::with_seed(seed),
            seeds,
        }
    }

    /// Returns the next input: one in ten is noise, one in twenty an unchanged seed.
    pub fn next(&mut self) -> Vec<u8> {
        let seed = self.random.usize(..self.seeds.len());
        match self.random.u8(..20) {
            0 | 1 => self.noise(600),
            2 => self.seeds[seed].clone(),
            _ => {
                let mut input = self.seeds[seed].clone();
                for _ in 0..=self.random.u8(..4) {
                    self.damage(&mut input);
                }
                input
            }
        }
    }

    /// Returns random bytes.
    pub fn noise(&mut self, longest: usize) -> Vec<u8> {
        let length = self.random.usize(..longest);
        std::iter::repeat_with(|| self.random.u8(..))
            .take(length)
            .collect()
    }

    fn damage(&mut self, input: &mut Vec<u8>) {
        let (start, end) = self.piece(input.len(), 40);
        match self.random.u8(..10) {
            0 if start < input.len() => input[start] ^= 1 << self.random.u8(..8),
            1 if start < input.len() => input[start] = self.random.u8(..),
            2 => {
                input.drain(start..end);
            }
            3 => {
                let piece = input[start..end].to_vec();
                let at = self.random.usize(..=input.len());
                input.splice(at..at, piece);
            }
            4 => {
                let token = TOKENS[self.random.usize(..TOKENS.len())];
                input.splice(start..start, token.bytes());
            }
            5 => {
                let token = TOKENS[self.random.usize(..TOKENS.len())];
                input.splice(start..end, token.bytes());
            }
            6 => {
                let other = &self.seeds[self.random.usize(..self.seeds.len())];
                let from = self.random.usize(..=other.len());
                let to = (from + self.random.usize(..60)).min(other.len());
                input.splice(start..start, other[from..to].iter().copied());
            }
            7 if self.random.u8(..4) == 0 => input.truncate(start),
            _ => self.change_number(input, start),
        }
    }

    /// Replaces the next number after a position.
    fn change_number(&mut self, input: &mut Vec<u8>, from: usize) {
        let is_of_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
        let Some(at) = input[from..].iter().position(is_of_number) else {
            return;
        };
        let start = from + at;
        let length = input[start..]
            .iter()
            .take_while(|byte| is_of_number(byte))
            .count();
        let number = match self.random.u8(..6) {
            0 => self.random.u64(..).to_string(),
            1 => TOKENS[self.random.usize(..10)].to_owned(),
            2 => format!("-{}", self.random.u8(..)),
            3 => format!("{:.3}", self.random.f64() * 100.0),
            _ => self.random.u8(..40).to_string(),
        };
        input.splice(start..start + length, number.bytes());
    }

    /// Returns a random range of at most `longest` bytes.
    fn piece(&mut self, length: usize, longest: usize) -> (usize, usize) {
        let start = self.random.usize(..=length);
        let end = start + self.random.usize(..=longest.min(length - start));
        (start, end)
    }
}
