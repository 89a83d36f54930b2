//! The source of a first start: the device that sends on a serial port, or none.

use ademan::capture::SourceUri;
use ademan::capture::recognition::{Recognition, camera, port_names, recognize};
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
    for port in &ports {
        println!("listening to {} for some seconds", escape(port));
        found.extend(listen(port));
    }
    if found.is_empty() && args.port.is_some() {
        return Err(Failure::wrong_use(
            "no device was recognized there; connect the glove and switch it on, or name its source with --source (see `ademan sources`)",
        ));
    }
    if found.is_empty() {
        propose_without_device(ports.is_empty());
        return Ok(None);
    }
    choose(found, questions).map(Some)
}

/// Returns the sources that a port may be, and says what it is.
fn listen(port: &str) -> Vec<SourceUri> {
    match recognize(port) {
        Ok(Recognition::Sources(sources)) => {
            for source in &sources {
                let protocol = source.protocol();
                let title = protocol.map_or("a device", |protocol| protocol.title());
                println!("  looks like {title}");
            }
            return sources;
        }
        Ok(Recognition::Unknown(bytes)) => println!(
            "  {bytes} bytes of no known device: check its bit rate; `ademan sources` lists the protocols"
        ),
        Ok(Recognition::Silent) => println!("  nothing arrives"),
        Err(reason) => println!("  cannot listen: {}", escape(&reason)),
    }
    Vec::new()
}

fn choose(mut found: Vec<SourceUri>, questions: &Questions) -> Result<SourceUri, Failure> {
    if found.len() == 1 {
        return Ok(found.remove(0));
    }
    for (index, source) in found.iter().enumerate() {
        println!("  {}  {}", index + 1, escape(&source.to_string()));
    }
    let count = found.len();
    let number = questions.ask("which one", "1", |answer| match answer.parse() {
        Ok(number) if (1..=count).contains(&number) => Ok(number),
        _ => Err(format!("answer with a number from 1 to {count}")),
    })?;
    Ok(found.remove(number - 1))
}

/// Says what to use without a device on a serial port.
fn propose_without_device(has_no_port: bool) {
    if has_no_port {
        println!("no serial port is present")
    } else {
        println!("no port has a known device")
    }
    if camera().is_some() {
        println!("a camera is there, which can follow your hand: ademan webcam");
    }
    println!("a simulated hand types instead, so that you see what happens");
}
