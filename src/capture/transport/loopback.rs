//! A line with a free end, for simulated gloves: what is written there arrives at a source.

use std::io::{ErrorKind, Result, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

use crate::capture::SourceUri;
use crate::capture::uri::StreamOptions;

#[cfg(not(unix))]
pub use self::open_tcp_loopback as open_loopback;
#[cfg(unix)]
pub use super::pty::open_loopback;

/// A line whose writing end is in this program.
///
/// Open the source before anything is written: like a real line, it forgets what nobody listened to.
/// It carries bytes as fast as they are written; the pace of the baud is up to the writer.
pub struct Loopback {
    /// Where the glove writes. Dropping it looks like an unplugged cable to the source, which may lose what it
    /// has not read by then.
    pub writer: Box<dyn Write + Send>,
    /// The other end.
    pub uri: SourceUri,
}

/// Opens a wire over TCP on the loopback address; the source may come, go and come again.
pub fn open_tcp_loopback(line: StreamOptions) -> Result<Loopback> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    listener.set_nonblocking(true)?;
    let address = listener.local_addr()?.to_string();
    let writer = TcpWriter {
        listener,
        peer: None,
    };
    Ok(Loopback {
        writer: Box::new(writer),
        uri: SourceUri::Tcp { address, line },
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
                    // Some systems hand the listener's mode on to the connection.
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
                // The source has gone and may come again; these bytes are lost as on a real line.
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
