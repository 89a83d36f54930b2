//! Messages of Open Sound Control in a datagram.

use crate::capture::protocol::{InvalidPacket, PacketError};

/// The deepest nesting of bundles; VMC nests two.
const MAX_DEPTH: usize = 8;

/// Header of a bundle; a time follows.
const BUNDLE: &[u8; 8] = b"#bundle\0";
const BUNDLE_TIME_BYTES: usize = 8;

/// A message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Message<'a> {
    /// The address, such as `/VMC/Ext/T`.
    pub address: &'a [u8],
    /// A letter for the type of each argument, `s` for strings and `f` for floats.
    types: &'a [u8],
    arguments: &'a [u8],
}

impl<'a> Message<'a> {
    /// Returns the first arguments if they are a string and `N` floats. Further ones are ignored.
    pub fn string_and_floats<const N: usize>(&self) -> Option<(&'a [u8], [f32; N])> {
        let (first, floats) = self.types.get(..=N)?.split_first()?;
        if *first != b's' || floats.iter().any(|&letter| letter != b'f') {
            return None;
        }
        let (string, rest) = split_string(self.arguments)?;
        let numbers = rest.as_chunks::<4>().0.get(..N)?;
        Some((
            string,
            std::array::from_fn(|index| f32::from_be_bytes(numbers[index])),
        ))
    }

    /// Returns the first argument, a whole number.
    pub fn int(&self) -> Result<i32, PacketError> {
        self.first(b'i').map(i32::from_be_bytes)
    }

    /// Returns the first argument, a finite number.
    pub fn float(&self) -> Result<f32, PacketError> {
        let float = self.first(b'f').map(f32::from_be_bytes)?;
        let reason = "the argument of a message is not finite";
        let is_finite = float.is_finite().then_some(float);
        is_finite.ok_or_else(|| error(InvalidPacket::NotFinite, reason))
    }

    /// Returns the bytes of the first argument, which has the type of this letter.
    fn first(&self, letter: u8) -> Result<[u8; 4], PacketError> {
        let missing = || {
            error(
                InvalidPacket::Truncated,
                "the argument of a message is missing",
            )
        };
        let reason = "the argument of a message has another type";
        match self.types.first().ok_or_else(missing)? {
            found if *found == letter => self.arguments.first_chunk().copied().ok_or_else(missing),
            _ => Err(error(InvalidPacket::Unknown, reason)),
        }
    }
}

/// Passes the messages of a datagram to `handle`, also from nested bundles. Returns the error of the first part that
/// cannot be read; the other parts are read.
pub(super) fn messages<'a>(
    datagram: &'a [u8],
    handle: &mut dyn FnMut(Message<'a>),
) -> Option<PacketError> {
    read(datagram, MAX_DEPTH, handle)
}

fn read<'a>(
    packet: &'a [u8],
    depth: usize,
    handle: &mut dyn FnMut(Message<'a>),
) -> Option<PacketError> {
    let Some(bundle) = packet.strip_prefix(BUNDLE) else {
        return match message(packet) {
            Some(message) => {
                handle(message);
                None
            }
            None => Some(error(InvalidPacket::Unknown, "a message is not valid OSC")),
        };
    };
    let Some(depth) = depth.checked_sub(1) else {
        return Some(error(
            InvalidPacket::WrongSize,
            "bundles are nested too deeply",
        ));
    };
    let Some(mut elements) = bundle.get(BUNDLE_TIME_BYTES..) else {
        return Some(error(InvalidPacket::Truncated, "a bundle has no time"));
    };
    let mut first_error = None;
    while !elements.is_empty() {
        let Some((element, rest)) = split_element(elements) else {
            let cut = error(InvalidPacket::Truncated, "a bundle ends inside a message");
            return first_error.or(Some(cut));
        };
        let result = read(element, depth, handle);
        first_error = first_error.or(result);
        elements = rest;
    }
    first_error
}

fn error(reason: InvalidPacket, text: &str) -> PacketError {
    PacketError::new(reason, text)
}

/// Splits the first element off the elements of a bundle. A negative length is larger than any bundle.
fn split_element(elements: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = elements.split_first_chunk()?;
    rest.split_at_checked(u32::from_be_bytes(*length) as usize)
}

fn message(bytes: &[u8]) -> Option<Message<'_>> {
    let (address, rest) = split_string(bytes)?;
    let (types, arguments) = split_string(rest)?;
    let is_address = address.first() == Some(&b'/');
    is_address.then_some(Message {
        address,
        types: types.strip_prefix(b",")?,
        arguments,
    })
}

/// Splits a string off, which ends with one to four zeros at a multiple of four bytes.
fn split_string(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = bytes.iter().position(|&byte| byte == 0)?;
    let rest = bytes.get((length / 4 + 1) * 4..)?;
    Some((&bytes[..length], rest))
}

/// Adds a string with its zeros.
fn push_string(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend_from_slice(text.as_bytes());
    bytes.resize((bytes.len() / 4 + 1) * 4, 0);
}

/// Returns a message without arguments but floats and, before them, a string or whole numbers.
pub fn encode(address: &str, string: Option<&str>, ints: &[i32], floats: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    push_string(&mut bytes, address);
    let types = [
        if string.is_some() { "s" } else { "" },
        &"i".repeat(ints.len()),
        &"f".repeat(floats.len()),
    ];
    push_string(&mut bytes, &format!(",{}", types.concat()));
    if let Some(string) = string {
        push_string(&mut bytes, string);
    }
    ints.iter().for_each(|int| bytes.extend(int.to_be_bytes()));
    floats
        .iter()
        .for_each(|float| bytes.extend(float.to_be_bytes()));
    bytes
}

/// Returns a bundle of messages or bundles, to be handled at once.
pub(super) fn bundle(elements: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = BUNDLE.to_vec();
    bytes.extend(1_u64.to_be_bytes());
    for element in elements {
        bytes.extend((element.len() as u32).to_be_bytes());
        bytes.extend(element);
    }
    bytes
}
