//! The layout that a sensor can use.

use ademan::capture::SampleKind;
use ademan::capture::protocol::PositionNoise;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::setup::Setup;

use super::question::Questions;
use crate::failure::Failure;

/// The keyboard of a hand whose arm is measured, and the one of fingers that bend anywhere.
const KEYBOARD: &str = "qwerty-flat";
const CHORDS: &str = "chords-bend";

/// The keyboard that starts where the hand is, for cameras.
const WEBCAM: &str = "webcam-qwerty";

/// The layout of a source that measures the movement of the arm only.
const ARM: &str = "arm-6dof";

/// Chooses the layout of a setup: the given one, or the answer to a proposal.
pub fn choose(
    given: Option<&str>,
    setup: &Setup,
    questions: &Questions,
) -> Result<String, Failure> {
    if let Some(name) = given {
        Layout::load(name)?;
        return Ok(name.to_owned());
    }
    let proposal = propose(setup)?;
    let layout = questions.ask("layout, or the file of one", &proposal, |name| {
        let loaded = Layout::load(name).map(|_| name.to_owned());
        loaded.map_err(|error| error.to_string())
    })?;
    println!("layout: {layout}");
    Ok(layout)
}

/// Returns the first layout whose keys the hand of a setup reaches.
pub fn propose(setup: &Setup) -> Result<String, Failure> {
    let protocol = setup.source.as_ref().and_then(|source| source.protocol());
    let noise = protocol.map(|protocol| protocol.position_noise);
    let candidates: &[&str] = match protocol.map(|protocol| protocol.sample) {
        Some(SampleKind::Displacement) => &[ARM],
        _ if noise == Some(PositionNoise::Landmarks) => &[WEBCAM, CHORDS],
        _ => &[KEYBOARD, CHORDS],
    };
    for candidate in candidates {
        let setup = Setup {
            layout: (*candidate).to_owned(),
            ..setup.clone()
        };
        let loaded = setup.load_files()?;
        if loaded.reach_report(&loaded.layout).is_none() {
            return Ok((*candidate).to_owned());
        }
    }
    Ok(candidates.last().copied().unwrap_or(KEYBOARD).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_gets_a_layout_that_it_can_use() {
        let proposal = |source: &str, glove: Option<&str>| {
            propose(&Setup {
                source: Some(source.parse().unwrap()),
                glove: glove.map(str::to_owned),
                ..Setup::default()
            })
            .unwrap()
        };
        let serial = "serial:/dev/ttyUSB0";
        assert_eq!(proposal(serial, None), KEYBOARD);
        let left = proposal(serial, Some("unam-hc11-left"));
        assert_eq!(left, CHORDS, "the board of the right hand is out of reach");
        let curls = "serial:/dev/ttyUSB0?protocol=lucidgloves";
        assert_eq!(proposal(curls, None), CHORDS);
        let webcam = proposal("udp:127.0.0.1:9000?protocol=hand-landmarks", None);
        assert_eq!(webcam, WEBCAM);
        assert_eq!(proposal("udp:127.0.0.1:4242?protocol=opentrack", None), ARM);
    }
}
