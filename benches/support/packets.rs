//! The packets of a simulated hand that types.

use ademan::capture::Hc11Format;
use ademan::capture::hc11::{BODY_BYTES, Framing, PACKET_BYTES, encode};
use ademan::setup::Setup;
use ademan::sim::SimulatedTypist;

/// Returns the packets of a hand that types two words.
pub fn packets() -> impl Iterator<Item = [u8; PACKET_BYTES]> {
    let setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist("hello world", &Hc11Format::default(), 0.5, 1);
    let mut typist: SimulatedTypist = typist.expect("the hand can type the text");
    std::iter::from_fn(move || typist.next_counts()).map(|counts| {
        let body: [u8; BODY_BYTES] = std::array::from_fn(|channel| counts[channel] as u8);
        encode(Framing::Double06, &body)
    })
}
