//! The wire format of protocol buffers, as far as recordings need it.
//!
//! <https://protobuf.dev/programming-guides/encoding/>. A field with the default value of its type is not written.

/// Value of a field on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// An integer or an enum.
    Varint(u64),
    /// A `double`.
    Fixed64(u64),
    /// A text, a message or packed numbers.
    Bytes(&'a [u8]),
    /// A `float`.
    Fixed32(u32),
}

/// Reason why bytes are not a message of the schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WireError {
    /// A field or a number is longer than the rest of the message.
    #[error("a field is longer than its message")]
    TooLong,
    /// The number of a field, or the type of its value, is not valid. The byte is the first one of the tag.
    #[error("byte {0} of a message is not the start of a field")]
    InvalidTag(u8),
    /// A field has another type than in the schema.
    #[error("field {0} has a value of another type")]
    WrongType(u32),
    /// A value that the schema or the program does not know.
    #[error("field {0} has an unknown value")]
    UnknownValue(u32),
    /// A list has more elements than the program accepts.
    #[error("field {0} has too many elements")]
    TooMany(u32),
    /// A reading without a sample.
    #[error("it has no sample")]
    NoSample,
}

/// A field: its number and its value.
pub type Field<'a> = (u32, Value<'a>);

/// Iterator over the fields of a message.
#[derive(Clone, Debug)]
pub struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    /// Creates an iterator over the fields of `message`.
    pub const fn new(message: &'a [u8]) -> Self {
        Self(message)
    }

    fn next_field(&mut self) -> Result<Field<'a>, WireError> {
        let first = self.0[0];
        let tag = take_varint(&mut self.0)?;
        let number = u32::try_from(tag >> 3).map_err(|_| WireError::InvalidTag(first))?;
        let value = match tag & 7 {
            _ if number == 0 => return Err(WireError::InvalidTag(first)),
            0 => Value::Varint(take_varint(&mut self.0)?),
            1 => Value::Fixed64(u64::from_le_bytes(self.take_array()?)),
            2 => {
                let length = take_varint(&mut self.0)?;
                let length = usize::try_from(length).map_err(|_| WireError::TooLong)?;
                let (bytes, rest) = self.0.split_at_checked(length).ok_or(WireError::TooLong)?;
                self.0 = rest;
                Value::Bytes(bytes)
            }
            5 => Value::Fixed32(u32::from_le_bytes(self.take_array()?)),
            _ => return Err(WireError::InvalidTag(first)),
        };
        Ok((number, value))
    }

    fn take_array<const N: usize>(&mut self) -> Result<[u8; N], WireError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(WireError::TooLong)?;
        self.0 = rest;
        Ok(*bytes)
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Result<Field<'a>, WireError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.0.is_empty() {
            return None;
        }
        let field = self.next_field();
        if field.is_err() {
            self.0 = &[];
        }
        Some(field)
    }
}

/// Splits a number of variable length off the front of `bytes`.
pub fn take_varint(bytes: &mut &[u8]) -> Result<u64, WireError> {
    let mut number = 0;
    for (index, &byte) in bytes.iter().take(10).enumerate() {
        number |= u64::from(byte & 0x7f) << (7 * index);
        if byte < 0x80 {
            *bytes = &bytes[index + 1..];
            return Ok(number);
        }
    }
    Err(WireError::TooLong)
}

/// Returns the value of an integer or an enum.
pub fn integer((number, value): Field) -> Result<u64, WireError> {
    match value {
        Value::Varint(value) => Ok(value),
        _ => Err(WireError::WrongType(number)),
    }
}

/// Returns the value of a `double`.
pub fn double((number, value): Field) -> Result<f64, WireError> {
    match value {
        Value::Fixed64(bits) => Ok(f64::from_bits(bits)),
        _ => Err(WireError::WrongType(number)),
    }
}

/// Returns the value of a `float`.
pub fn float((number, value): Field) -> Result<f32, WireError> {
    match value {
        Value::Fixed32(bits) => Ok(f32::from_bits(bits)),
        _ => Err(WireError::WrongType(number)),
    }
}

/// Returns the bytes of a text, a message or packed numbers.
pub fn bytes<'a>((number, value): Field<'a>) -> Result<&'a [u8], WireError> {
    match value {
        Value::Bytes(bytes) => Ok(bytes),
        _ => Err(WireError::WrongType(number)),
    }
}

/// Returns the fields of an embedded message.
pub fn message<'a>(field: Field<'a>) -> Result<Fields<'a>, WireError> {
    bytes(field).map(Fields::new)
}

/// Returns a text.
pub fn text<'a>(field: Field<'a>) -> Result<&'a str, WireError> {
    std::str::from_utf8(bytes(field)?).map_err(|_| WireError::UnknownValue(field.0))
}

/// Appends a number of variable length.
pub fn put_varint(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn put_tag(out: &mut Vec<u8>, field: u32, wire_type: u32) {
    put_varint(out, u64::from(field << 3 | wire_type));
}

/// Appends an integer or an enum, unless it is 0.
pub fn put_integer(out: &mut Vec<u8>, field: u32, value: u64) {
    if value != 0 {
        put_present_integer(out, field, value);
    }
}

/// Appends an integer, also if it is 0, as a `oneof` needs.
pub fn put_present_integer(out: &mut Vec<u8>, field: u32, value: u64) {
    put_tag(out, field, 0);
    put_varint(out, value);
}

/// Appends an `optional double`.
pub fn put_double(out: &mut Vec<u8>, field: u32, value: f64) {
    put_tag(out, field, 1);
    out.extend(value.to_le_bytes());
}

/// Appends a `double`, unless it is +0.
pub fn put_nonzero_double(out: &mut Vec<u8>, field: u32, value: f64) {
    if value.to_bits() != 0 {
        put_double(out, field, value);
    }
}

/// Appends an `optional float`.
pub fn put_float(out: &mut Vec<u8>, field: u32, value: f32) {
    put_tag(out, field, 5);
    out.extend(value.to_le_bytes());
}

/// Appends a `float`, unless it is +0.
pub fn put_nonzero_float(out: &mut Vec<u8>, field: u32, value: f32) {
    if value.to_bits() != 0 {
        put_float(out, field, value);
    }
}

/// Appends a text or a message that is complete.
pub fn put_bytes(out: &mut Vec<u8>, field: u32, bytes: &[u8]) {
    put_tag(out, field, 2);
    put_varint(out, bytes.len() as u64);
    out.extend(bytes);
}

/// Appends the message or the packed numbers that `put` appends.
pub fn put_message(out: &mut Vec<u8>, field: u32, put: impl FnOnce(&mut Vec<u8>)) {
    put_tag(out, field, 2);
    let start = out.len();
    // The length is known at the end. It has one byte up to 127; a longer one moves the content.
    out.push(0);
    put(out);
    let length = out.len() - start - 1;
    if length < 0x80 {
        out[start] = length as u8;
        return;
    }
    let mut prefix = [0; 10];
    let mut size = 0;
    let mut rest = length;
    while rest > 0 {
        prefix[size] = rest as u8 | 0x80;
        rest >>= 7;
        size += 1;
    }
    prefix[size - 1] &= 0x7f;
    let end = out.len();
    out.resize(end + size - 1, 0);
    out.copy_within(start + 1..end, start + size);
    out[start..start + size].copy_from_slice(&prefix[..size]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_messages_of_any_length_survive() {
        for number in [0, 1, 127, 128, 300, 1 << 35, u64::MAX] {
            let mut out = Vec::new();
            put_varint(&mut out, number);
            assert_eq!(take_varint(&mut &out[..]), Ok(number));
        }
        for length in [0, 1, 127, 128, 16_383, 16_384, 70_000] {
            let content = vec![7; length];
            let mut out = Vec::new();
            put_message(&mut out, 3, |out| out.extend(&content));
            put_integer(&mut out, 4, 5);
            let fields: Result<Vec<_>, _> = Fields::new(&out).collect();
            let expected = vec![(3, Value::Bytes(&content)), (4, Value::Varint(5))];
            assert_eq!(fields, Ok(expected));
        }
    }

    #[test]
    fn the_examples_of_the_specification_are_read() {
        let fields = |bytes| Fields::new(bytes).collect::<Result<Vec<_>, _>>();
        assert_eq!(
            fields(&[0x08, 0x96, 0x01]),
            Ok(vec![(1, Value::Varint(150))])
        );
        let testing = b"\x12\x07testing";
        assert_eq!(fields(testing), Ok(vec![(2, Value::Bytes(b"testing"))]));
        assert_eq!(fields(b""), Ok(vec![]));
    }

    #[test]
    fn bytes_that_are_no_message_are_refused() {
        let error = |bytes| Fields::new(bytes).find_map(Result::err);
        assert_eq!(error(&[0x08]), Some(WireError::TooLong));
        assert_eq!(error(&[0x12, 0x05, 1]), Some(WireError::TooLong));
        assert_eq!(error(&[0x09, 0, 0]), Some(WireError::TooLong));
        assert_eq!(error(&[0x03]), Some(WireError::InvalidTag(3)));
        assert_eq!(error(&[0x00, 0x00]), Some(WireError::InvalidTag(0)));
        assert_eq!(error(&[0xff; 11]), Some(WireError::TooLong));
    }
}
