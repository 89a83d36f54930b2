//! Loopback connections for simulated gloves: bytes written to one end arrive at a source.

#[cfg(unix)]
mod pty;

use std::io::{ErrorKind, Result, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

use super::SourceUri;
use super::protocol::StreamFormat;
use super::transport::{StreamUri, tcp};

#[cfg(not(unix))]
pub use self::open_tcp_loopback as open_loopback;
#[cfg(unix)]
pub use pty::open_loopback;

/// A connection whose writing end is in this program.
///
/// Open the source before writing: bytes that are written without a reader are lost, as on a cable. The connection
/// is not paced; the writer has to keep to the bit rate.
pub struct Loopback {
    /// Writing end. Dropping it looks like an unplugged cable to the source, which may lose unread bytes.
    pub writer: Box<dyn Write + Send>,
    /// Source at the other end.
    pub uri: SourceUri,
}

/// Opens a TCP connection on the loopback address. The source may disconnect and connect again.
pub fn open_tcp_loopback(format: impl Into<StreamFormat>) -> Result<Loopback> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    listener.set_nonblocking(true)?;
    let address = listener.local_addr()?.to_string();
    let writer = TcpWriter {
        listener,
        peer: None,
    };
    Ok(Loopback {
        writer: Box::new(writer),
        uri: SourceUri::Stream(StreamUri::new(&tcp::TRANSPORT, address, format)),
    })
}

struct TcpWriter {
    listener: TcpListener,
    peer: Option<TcpStream>,
}

impl TcpWriter {
    fn peer(&mut self) -> Result<Option<&mut TcpStream>> {
        if self.peer.is_none() {
            match self.listener.accept() {
                Ok((stream, _)) => {
                    // On some systems the connection inherits the non-blocking mode of the listener.
                    stream.set_nonblocking(false)?;
                    stream.set_nodelay(true)?;
                    self.peer = Some(stream);
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(error),
            }
        }
        Ok(self.peer.as_mut())
    }
}

impl Write for TcpWriter {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let Some(peer) = self.peer()? else {
            return Ok(bytes.len());
        };
        match peer.write(bytes) {
            Err(error) if error.kind() != ErrorKind::Interrupted => {
                // The source has disconnected and may connect again; these bytes are lost.
                self.peer = None;
                Ok(bytes.len())
            }
            result => result,
        }
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}
