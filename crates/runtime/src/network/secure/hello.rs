//! The first bytes of a connection: the token of the client and the answer of the server.

use std::io::{self, ErrorKind, Read, Write};

use super::token::Token;

const PREFIX: &[u8] = b"token ";

/// The length of the line of the client.
const HELLO_BYTES: usize = PREFIX.len() + 64 + 1;

const OK: &[u8] = b"ok\n";
const REFUSED: &[u8] = b"refused\n";

/// Sends the token of a client.
pub fn send(stream: &mut impl Write, token: &Token) -> io::Result<()> {
    let hello = format!("token {}\n", token.to_hex());
    stream.write_all(hello.as_bytes())?;
    stream.flush()
}

/// Receives the token of a client. `None` if the line is not a token.
pub fn receive(stream: &mut impl Read) -> io::Result<Option<Token>> {
    let mut hello = [0; HELLO_BYTES];
    // One byte too many is never taken, as it belongs to what follows.
    stream.read_exact(&mut hello)?;
    let digits = hello
        .strip_prefix(PREFIX)
        .and_then(|rest| rest.strip_suffix(b"\n"));
    let digits = digits.and_then(|digits| str::from_utf8(digits).ok());
    Ok(digits.and_then(Token::from_hex))
}

/// Answers a client.
pub fn answer(stream: &mut impl Write, is_admitted: bool) -> io::Result<()> {
    stream.write_all(if is_admitted { OK } else { REFUSED })?;
    stream.flush()
}

/// Receives the answer of a server, and no byte after it. Returns `true` if the client is admitted.
pub fn receive_answer(stream: &mut impl Read) -> io::Result<bool> {
    let mut answer = [0; OK.len()];
    stream.read_exact(&mut answer)?;
    match answer.as_slice() {
        OK => Ok(true),
        start if REFUSED.starts_with(start) => Ok(false),
        _ => Err(io::Error::new(
            ErrorKind::InvalidData,
            "the server did not answer as ademan does",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_and_its_answer_pass_and_no_byte_after_them_is_read() {
        let token = Token::generate().unwrap();
        let mut bytes = Vec::new();
        send(&mut bytes, &token).unwrap();
        bytes.extend(b"data");
        let mut rest = bytes.as_slice();
        let received = receive(&mut rest).unwrap().unwrap();
        assert_eq!((received.hash(), rest), (token.hash(), &b"data"[..]));
        for is_admitted in [true, false] {
            let mut answered = Vec::new();
            answer(&mut answered, is_admitted).unwrap();
            assert_eq!(
                receive_answer(&mut answered.as_slice()).unwrap(),
                is_admitted
            );
        }
        assert!(receive_answer(&mut &b"HTTP/1.1 400"[..]).is_err());
    }

    #[test]
    fn anything_else_is_no_token() {
        let mut get = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n".to_vec();
        get.resize(HELLO_BYTES, b'a');
        let other_word = format!("tokem {}\n", "a".repeat(64)).into_bytes();
        let other_end = format!("token {} ", "a".repeat(64)).into_bytes();
        for line in [other_word, other_end] {
            assert!(receive(&mut line.as_slice()).unwrap().is_none());
        }
        for line in [
            get,
            vec![0; HELLO_BYTES],
            vec![0xff; HELLO_BYTES],
            vec![b'a'; HELLO_BYTES],
        ] {
            assert!(receive(&mut line.as_slice()).unwrap().is_none());
        }
        let cut = format!("token {}\n", "a".repeat(63));
        assert!(receive(&mut cut.as_bytes()).is_err());
    }
}
