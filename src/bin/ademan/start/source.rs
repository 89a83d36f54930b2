//! The source of a first start: the device that sends on a serial port, or none.

use std::io::{self, Write};

use ademan::capture::SourceUri;
use ademan::capture::cameras::cameras;
use ademan::capture::recognition::{Recognition, port_names, recognize};
use ademan::message::escape;

use super::Args;
use super::question::Questions;
use crate::failure::Failure;

/// Finds the source, or asks which one it is. Returns `None` for the simulated hand.
pub fn find(args: &Args, questions: &Questions) -> Result<Option<SourceUri>, Failure> {
    if args.simulated {
        return Ok(None);
    }
    if let Some(source) = &args.source {
        return Ok(Some(source.clone()));
    }
    let ports = match &args.port {
        Some(port) => vec![port.clone()],
        None => port_names(),
    };
    let mut found = Vec::new();
    let mut out = io::stdout();
    for port in &ports {
        writeln!(out, "listening to {} for a few seconds", escape(port))?;
        found.extend(listen(port, &mut out)?);
    }
    if found.is_empty() && args.port.is_some() {
        return Err(Failure::wrong_use(
            "no device was recognized there; connect the glove and switch it on, or name its source with --source (see `ademan sources`)",
        ));
    }
    if found.is_empty() {
        propose_without_device(ports.is_empty(), &mut out)?;
        return Ok(None);
    }
    choose(found, questions).map(Some)
}

/// Returns the sources that a port may be, and prints what was recognized.
fn listen(port: &str, out: &mut impl Write) -> io::Result<Vec<SourceUri>> {
    match recognize(port) {
        Ok(Recognition::Sources(sources)) => {
            for source in &sources {
                let protocol = source.protocol();
                let title = protocol.map_or("a device", |protocol| protocol.title());
                writeln!(out, "  looks like {title}")?;
            }
            return Ok(sources);
        }
        Ok(Recognition::Unknown(bytes)) => writeln!(
            out,
            "  {bytes} bytes of no known device: check its bit rate; `ademan sources` lists the protocols"
        )?,
        Ok(Recognition::Silent) => writeln!(out, "  nothing arrives")?,
        Err(reason) => writeln!(out, "  cannot listen: {}", escape(&reason))?,
    }
    Ok(Vec::new())
}

fn choose(mut found: Vec<SourceUri>, questions: &Questions) -> Result<SourceUri, Failure> {
    if found.len() == 1 {
        return Ok(found.remove(0));
    }
    let mut out = io::stdout();
    for (index, source) in found.iter().enumerate() {
        let number = index + 1;
        writeln!(out, "  {number}  {}", escape(&source.to_string()))?;
    }
    let count = found.len();
    let number = questions.ask("which one", "1", |answer| match answer.parse() {
        Ok(number) if (1..=count).contains(&number) => Ok(number),
        _ => Err(format!("answer with a number from 1 to {count}")),
    })?;
    Ok(found.remove(number - 1))
}

/// Reports the sources that need no device on a serial port.
fn propose_without_device(has_no_port: bool, out: &mut impl Write) -> io::Result<()> {
    if has_no_port {
        writeln!(out, "no serial port is present")?;
    } else {
        writeln!(out, "no port has a known device")?;
    }
    if let Some(camera) = cameras().first() {
        let command = camera.command();
        writeln!(
            out,
            "a camera is connected; to follow your hand with it: {command}"
        )?;
    }
    writeln!(
        out,
        "a simulated hand types instead, so that you see what happens"
    )
}
