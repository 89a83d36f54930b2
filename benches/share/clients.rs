//! The clients, in a process of their own: one thread reads all of them.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Clients of the text line, and of the WebSocket.
pub const TCP_CLIENTS: usize = 100;
pub const SOCKET_CLIENTS: usize = 20;

/// Connects to both servers, prints a line, and reads until the standard input ends.
pub fn read_all(addresses: &str) {
    let (lines, socket) = addresses.split_once(' ').expect("two addresses");
    let mut clients: Vec<TcpStream> = Vec::new();
    for _ in 0..TCP_CLIENTS {
        clients.push(TcpStream::connect(lines).expect("a server"));
    }
    for _ in 0..SOCKET_CLIENTS {
        clients.push(open_socket(socket));
    }
    for client in &clients {
        client.set_nonblocking(true).expect("a socket");
    }
    println!("connected");
    let end = std::thread::spawn(|| std::io::stdin().read(&mut [0; 1]));
    let mut buffer = vec![0; 1 << 18];
    let mut bytes = vec![0_u64; clients.len()];
    while !end.is_finished() {
        for (client, received) in clients.iter_mut().zip(&mut bytes) {
            match client.read(&mut buffer) {
                Ok(0) => panic!("a client was disconnected"),
                Ok(count) => *received += count as u64,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => panic!("{error}"),
            }
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let (tcp, sockets) = bytes.split_at(TCP_CLIENTS);
    let range = |counts: &[u64]| {
        let least = counts.iter().min().copied().unwrap_or_default();
        format!(
            "{least} to {}",
            counts.iter().max().copied().unwrap_or_default()
        )
    };
    println!(
        "bytes per client: TCP {}, WebSocket {}",
        range(tcp),
        range(sockets)
    );
}

/// Opens a WebSocket that asks for all poses and events.
fn open_socket(address: &str) -> TcpStream {
    let stream = TcpStream::connect(address).expect("a server");
    let url = format!("ws://{address}/");
    let (mut socket, _) = tungstenite::client(url, stream).expect("a WebSocket");
    let request = r#"{"kinds":["pose","events","scene"]}"#;
    socket.send(request.into()).expect("the server runs");
    let mut tcp_stream = socket.into_inner();
    tcp_stream.flush().expect("the server runs");
    tcp_stream
}
