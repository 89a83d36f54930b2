//! `ademan sources`: the kinds of source, and the protocols of streams.

use ademan::capture::protocol::{Carriers, PROTOCOLS, Protocol};
use ademan::capture::transport::Scheme;
use ademan::capture::uri::schemes;

use crate::failure::Failure;
pub use crate::list::ListArgs as Args;
use crate::list::Row;

pub fn run(args: Args) -> Result<(), Failure> {
    let protocols = PROTOCOLS.iter().map(|protocol| protocol_row(protocol));
    let rows: Vec<Row> = schemes().map(scheme_row).chain(protocols).collect();
    args.print(&rows)
}

fn scheme_row(scheme: Scheme) -> Row {
    Row {
        name: scheme.syntax.into(),
        summary: scheme.summary.into(),
        example: Some(format!("ademan run --source '{}'", scheme.example)),
    }
}

fn protocol_row(protocol: &Protocol) -> Row {
    let transport = match protocol.carriers {
        Carriers::Datagrams => "udp:127.0.0.1:9000",
        Carriers::Any | Carriers::Streams => "stdin:",
    };
    Row {
        name: format!("?protocol={}", protocol.name),
        summary: protocol.summary.into(),
        example: Some(format!(
            "ademan run --source '{transport}?protocol={}'",
            protocol.name
        )),
    }
}
