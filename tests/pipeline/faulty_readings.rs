//! Readings that do not show the hand: nothing unintended is typed, and no key stays pressed.

use ademan::capture::Reading;
use ademan::capture::hc11::{BODY_BYTES, PACKET_BYTES};
use ademan::capture::protocol::{Decoder, InvalidPacket, text_line};
use ademan::device::{EventKind, Events};
use ademan::estimate::{
    AffineMap, ChannelMap, ChannelRow, Estimator, EstimatorSettings, Rejection, Smoothing,
};
use ademan::hand::{Dof, Finger, FingerSet, Side};
use ademan::layout::Layout;
use ademan::setup::LoadedSetup;
use ademan::time::Timestamp;

use crate::support::checked::CheckedPipeline;
use crate::support::press::{self, Posture, Press, glove_format, typing};
use crate::support::source::typing_estimates;
use crate::support::wearer::{GloveWearer, default_setup, packets, pipeline_with};

/// A channel of the shipped glove.
const ELBOW: usize = 17;

/// Returns a glove whose wearer holds the key H.
fn holding(press: &Press) -> GloveWearer {
    let mut wearer = GloveWearer::new(&default_setup());
    wearer.play(&press.approach);
    wearer.play(&[press.pressed(); 20]);
    assert_eq!(wearer.take_events(), "down H");
    wearer
}

fn with(posture: &Posture, channel: usize, count: u8) -> Posture {
    let mut changed = *posture;
    changed[channel] = count;
    changed
}

/// Checks that a press types again, after a fault of a channel.
fn assert_repaired(wearer: &mut GloveWearer, press: &Press, channel: usize) {
    wearer.play(&[press.clear(); 300]);
    wearer.play(&press.approach);
    wearer.play(&press.lift);
    let typed = wearer.take_events();
    assert_eq!(typed, "down H, up H", "repaired: channel {channel}");
}

/// Returns the packets of a hand that plays a script.
fn postures(loaded: &LoadedSetup, script: &str) -> Vec<Posture> {
    let typist = loaded.scripted(script, &glove_format(), 0.0, 0);
    press::postures(typist.unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn a_stream_that_starts_inside_a_packet_types_the_same() {
    let press = Press::for_text("h");
    let loaded = default_setup();
    let whole = [&press.approach[..], &press.lift[..]].concat();
    let bytes = packets(&whole);
    for missing in 1..PACKET_BYTES {
        let mut wearer = GloveWearer::new(&loaded);
        wearer.send(&bytes[missing..]);
        assert_eq!(
            wearer.take_events(),
            "down H, up H",
            "{missing} bytes are missing"
        );
        // The last packet is complete with the marks of the next one.
        assert_eq!(wearer.readings() as usize, whole.len() - 2, "{missing}");
    }
}

/// Returns the lines of a hand in the order in which a network delivers them: it loses every third, doubles others, and lets up to ten
/// lines overtake each.
fn delivered(lines: &[Vec<u8>], random: &mut fastrand::Rng) -> Vec<u8> {
    let mut arrivals = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        if random.usize(..3) > 0 {
            for _ in 0..random.usize(1..=2) {
                arrivals.push((index + random.usize(..=10), line));
            }
        }
    }
    arrivals.sort_by_key(|(arrival, _)| *arrival);
    let in_order = arrivals.into_iter().map(|(_, line)| line.as_slice());
    in_order.collect::<Vec<_>>().concat()
}

#[test]
fn lines_that_a_network_loses_doubles_and_reorders_add_no_press() {
    let (estimates, _) = typing_estimates("hello");
    let still = std::iter::repeat_n(&estimates[0], 100);
    let mut lines = Vec::new();
    for (index, estimate) in (1..).zip(still.chain(&estimates)) {
        let mut line = Vec::new();
        let time = Timestamp(index * 5_729);
        text_line::write(&estimate.angles, Some(time), &mut line);
        lines.push(line);
    }
    let mut random = fastrand::Rng::with_seed(20);
    let mut typed = 0;
    for round in 0..20 {
        let mut decoder = text_line::decoder();
        let mut readings = Vec::new();
        decoder.push(&delivered(&lines, &mut random), &mut |packet| {
            let time = packet.time.expect("a line with a time");
            readings.push(Reading::new(time, None, packet.sample));
        });
        let out_of_order = decoder.stats().invalid.get(InvalidPacket::OutOfOrder);
        assert!(out_of_order > 100, "{round}: {out_of_order}");
        let mut pipeline = CheckedPipeline::new(&default_setup());
        let mut rest = "HELLO".chars();
        for reading in &readings {
            let mut events = Events::new();
            let _ = pipeline.step(reading, &mut events);
            for event in &events {
                if let EventKind::KeyDown(key) = event.kind {
                    let is_part = rest.any(|letter| key.to_string() == letter.to_string());
                    assert!(is_part, "{round}: {key}");
                    typed += 1;
                }
            }
        }
    }
    assert!(typed > 50, "{typed} of 100 keys");
}

#[test]
fn one_flipped_bit_changes_no_event_and_costs_at_most_two_packets() {
    let press = Press::for_text("h");
    let loaded = default_setup();
    let repeated = [press.pressed(); 12];
    let clean = packets(&repeated);
    for bit in 0..PACKET_BYTES * 8 {
        let mut wearer = GloveWearer::new(&loaded);
        wearer.play(&press.approach);
        wearer.play(&[press.pressed(); 20]);
        let before = wearer.readings();
        let mut bytes = clean.clone();
        bytes[3 * PACKET_BYTES + bit / 8] ^= 1 << (bit % 8);
        wearer.send(&bytes);
        let readings = wearer.readings() - before;
        // A broken mark belongs to the packet before it and to its own.
        assert!(
            readings as usize >= repeated.len() - 2,
            "bit {bit}: {readings}"
        );
        wearer.play(&press.lift);
        assert_eq!(wearer.take_events(), "down H, up H", "bit {bit}");
    }
}

#[test]
fn a_railed_sensor_releases_the_key_of_its_finger_and_the_others_keep_typing() {
    let h = Press::for_text("h");
    let loaded = default_setup();
    let two_fingers = postures(
        &loaded,
        "press J; set middle-pip-flexion 40 & bend middle 20; wait 200; bend middle 45; wait 200; \
         bend middle 20; wait 200; lift",
    );
    let mut healthy = GloveWearer::new(&loaded);
    healthy.play(&two_fingers);
    assert_eq!(healthy.take_events(), "down J, down 8, up 8, up J");
    let index = FingerSet::NONE.with(Finger::Index);
    let map = &loaded.glove.as_ref().expect("a glove").map;
    let channels: Vec<usize> = (0..BODY_BYTES)
        .filter(|&channel| map.fingers_affected_by(channel) == index)
        .collect();
    assert!(channels.len() >= 3, "{channels:?}");
    for (channel, end) in channels
        .iter()
        .flat_map(|&channel| [(channel, 0), (channel, 255)])
    {
        let mut wearer = holding(&h);
        let broken = with(&h.pressed(), channel, end);
        // A second has 175 readings; a jump is accepted a few readings later.
        wearer.play(&[broken; 185]);
        assert_eq!(wearer.take_events(), "up H", "channel {channel} at {end}");
        let broken_posture = |posture: &Posture| with(posture, channel, end);
        let rail = |postures: &[Posture]| postures.iter().map(broken_posture).collect::<Vec<_>>();
        wearer.play(&rail(&h.lift));
        wearer.play(&rail(&[two_fingers[0]; 60]));
        wearer.play(&rail(&two_fingers));
        assert_eq!(
            wearer.take_events(),
            "down 8, up 8",
            "channel {channel} at {end}"
        );
        assert_repaired(&mut wearer, &h, channel);
    }
}

#[test]
fn a_hand_that_jumps_to_and_fro_releases_at_the_third_reading_and_presses_nothing() {
    let press = Press::for_text("h");
    let mut wearer = holding(&press);
    let elbow = press.pressed()[ELBOW];
    for (number, away) in [120, 60, 120, 60, 120, 60].into_iter().enumerate() {
        let elsewhere = with(&press.pressed(), ELBOW, elbow + away);
        let rejection = wearer.show_after(5_729, &elsewhere);
        assert_eq!(rejection, Some(Rejection::TooFast));
        assert_eq!(wearer.take_events(), if number == 2 { "up H" } else { "" });
    }
    wearer.play(&[press.pressed(); 60]);
    assert_eq!(
        wearer.take_events(),
        "",
        "the finger has to leave the key first"
    );
    wearer.play(&press.lift);
    wearer.play(&press.approach);
    assert_eq!(wearer.take_events(), "down H");
}

#[test]
fn readings_that_are_missing_while_a_finger_goes_to_the_next_key_press_no_key_on_the_way() {
    const PERIOD: u64 = 5_729;
    // The gap is 195 ms long: less than the stall timeout.
    const MISSING: usize = 33;
    const KEYS: [&str; 5] = ["H", "E", "L", "L", "O"];
    let loaded = default_setup();
    let text = typing("hello");
    let mut missed = 0;
    for start in (60..text.len() - MISSING).step_by(3) {
        let mut wearer = GloveWearer::new(&loaded);
        let mut since = 0;
        for (index, posture) in text.iter().enumerate() {
            since += PERIOD;
            if !(start..start + MISSING).contains(&index) {
                wearer.show_after(since, posture);
                since = 0;
            }
        }
        assert_eq!(wearer.pipeline.stalls(), 0, "{start}");
        let typed = wearer.take_events();
        let presses = typed.split(", ").filter_map(|it| it.strip_prefix("down "));
        let presses: Vec<&str> = presses.collect();
        let mut keys = KEYS.into_iter();
        let is_part = presses.iter().all(|press| keys.any(|key| key == *press));
        assert!(is_part, "from reading {start}: {typed}");
        missed += KEYS.len() - presses.len();
    }
    assert!(missed > 0, "no gap hides a tap");
}

#[test]
fn infinite_angles_are_rejected_and_the_third_in_a_row_releases_everything() {
    const SPARE: usize = 63;
    let press = Press::for_text("h");
    let loaded = default_setup();
    let mut rows = loaded.glove.as_ref().expect("a glove").map.rows().to_vec();
    assert!(rows.iter().all(|row| row.channel != SPARE));
    rows.push(ChannelRow {
        label: "without end".into(),
        dof: Dof::ForearmSecondBone,
        channel: SPARE,
        calibration: AffineMap {
            gain: 1e308,
            offset: 0.0,
        },
    });
    let map = ChannelMap::new(rows, 255);
    let settings = EstimatorSettings {
        rail_timeout: None,
        ..EstimatorSettings::default()
    };
    let mut wearer = GloveWearer::with_pipeline(pipeline_with(
        &loaded,
        Estimator::new(settings).with_channels(&map),
    ));
    let without_spare = |postures: &[Posture]| -> Vec<Posture> {
        let without_spare = postures.iter().map(|posture| with(posture, SPARE, 0));
        without_spare.collect()
    };
    wearer.play(&without_spare(&press.approach));
    assert_eq!(wearer.take_events(), "down H");
    let (held, endless) = (
        without_spare(&[press.pressed()])[0],
        with(&press.pressed(), SPARE, 255),
    );
    for _ in 0..2 {
        for _ in 0..2 {
            let rejection = wearer.show_after(5_729, &endless);
            assert_eq!(rejection, Some(Rejection::NotFinite));
        }
        assert_eq!(wearer.show_after(5_729, &held), None);
    }
    assert_eq!(wearer.take_events(), "", "two in a row are rejected only");
    for _ in 0..3 {
        wearer.show_after(5_729, &endless);
    }
    assert_eq!(wearer.take_events(), "up H");
    wearer.show_after(5_729, &held);
    assert_eq!(
        wearer.take_events(),
        "",
        "the finger has to leave the key first"
    );
}

#[test]
fn a_clock_that_jumps_or_stops_releases_everything_and_is_counted() {
    const HOUR: u64 = 3_600_000_000;
    let press = Press::for_text("h");
    let mut ahead = holding(&press);
    ahead.show_after(HOUR, &press.pressed());
    assert_eq!(ahead.take_events(), "up H");
    assert_eq!(ahead.pipeline.stalls(), 1);
    assert!(!ahead.is_running(), "output has to be armed again");

    for back in [HOUR, 0] {
        let mut wearer = holding(&press);
        wearer.now += HOUR;
        wearer
            .pipeline
            .set_stall_timeout(std::time::Duration::from_secs(7_200));
        wearer.show(&press.pressed());
        let stale = || Rejection::OutOfOrder;
        wearer.now -= back;
        for _ in 0..3 {
            assert_eq!(wearer.show(&press.pressed()), Some(stale()));
        }
        assert_eq!(wearer.take_events(), "up H", "{back} µs back");
        assert_eq!(wearer.pipeline.rejected()[stale().index()], 3);
    }
}

#[test]
fn a_million_readings_a_second_stay_within_the_press_rate_limit() {
    let press = Press::for_text("h");
    let loaded = default_setup();
    let stroke = [&press.approach[..], &press.lift[..]].concat();
    // Without the filter, which slows such a hand down.
    let settings = EstimatorSettings {
        smoothing: Smoothing::Off,
        ..EstimatorSettings::default()
    };
    for interval in [1, 20, 100, 1_000] {
        let estimator =
            Estimator::new(settings).with_channels(&loaded.glove.as_ref().expect("a glove").map);
        let mut wearer = GloveWearer::with_pipeline(pipeline_with(&loaded, estimator));
        for posture in stroke.iter().cycle().take(100 * stroke.len()) {
            wearer.show_after(interval, posture);
        }
        let typed = wearer.take_events();
        let presses = typed.matches("down").count();
        println!("a reading every {interval} µs: {presses} presses");
        let allowed = 30 + wearer.now * 60 / 1_000_000;
        assert!(presses as u64 <= allowed, "{interval} µs: {presses}");
        assert_eq!(presses, typed.matches("up").count());
        assert!(interval < 1_000 || presses > 0);
    }
}

/// Returns postures, one of whose channels is a loose wire.
fn loose(postures: &[Posture], channel: usize, random: &mut fastrand::Rng) -> Vec<Posture> {
    let loose = |posture| with(posture, channel, random.u8(..));
    postures.iter().map(loose).collect()
}

#[test]
fn a_loose_wire_types_nothing_and_the_other_fingers_type() {
    let h = Press::for_text("h");
    let loaded = default_setup();
    let map = &loaded.glove.as_ref().expect("a glove").map;
    let text = typing("hola mundo");
    let (mut of_index, mut of_others) = (0, 0);
    for channel in map.rows().iter().map(|row| row.channel) {
        let mut random = fastrand::Rng::with_seed(channel as u64);
        let mut wearer = GloveWearer::new(&loaded);
        wearer.play(&[h.clear(); 60]);
        wearer.play(&loose(&[h.clear(); 30 * 175], channel, &mut random));
        assert_eq!(wearer.take_events(), "", "channel {channel}, at rest");
        let right = wearer.pipeline.implausible()[Side::Right.index()];
        assert!(right.angles.iter().all(|dof| {
            map.rows()
                .iter()
                .any(|row| row.dof == dof && row.channel == channel)
        }));
        assert!(!right.angles.is_empty(), "channel {channel}");
        wearer.play(&loose(&text, channel, &mut random));
        let typed = wearer.take_events();
        if map.fingers_affected_by(channel).contains(Finger::Index) {
            assert_eq!(typed, "", "channel {channel}");
            of_index += 1;
        } else {
            assert_eq!(
                typed.matches("down").count(),
                10,
                "channel {channel}: {typed}"
            );
            of_others += 1;
        }
        assert_repaired(&mut wearer, &h, channel);
        let repaired = wearer.pipeline.implausible()[Side::Right.index()];
        assert!(repaired.angles.is_empty(), "channel {channel}");
    }
    assert!(of_index > 5 && of_others > 10, "{of_index} {of_others}");
}

#[test]
fn a_wire_that_comes_loose_while_a_hand_types_adds_no_key() {
    let loaded = default_setup();
    let map = &loaded.glove.as_ref().expect("a glove").map;
    let text = typing("hola mundo ");
    let in_text = ["H", "O", "L", "A", "Space", "M", "U", "N", "D"];
    let (mut presses, mut others) = (0, String::new());
    for channel in map.rows().iter().map(|row| row.channel) {
        let mut random = fastrand::Rng::with_seed(channel as u64);
        for _ in 0..5 {
            let mut wearer = GloveWearer::new(&loaded);
            let healthy = random.usize(..text.len());
            wearer.play(&text[..healthy]);
            wearer.play(&loose(&text[healthy..], channel, &mut random));
            let typed = wearer.take_events();
            assert_eq!(typed.matches("down").count(), typed.matches("up").count());
            for key in typed
                .split(", ")
                .filter_map(|event| event.strip_prefix("down "))
            {
                presses += 1;
                if !in_text.contains(&key) {
                    others += &format!("{channel}: {key} ");
                }
            }
        }
    }
    assert!(presses > 300);
    assert_eq!(others, "");
}

#[test]
fn a_sensor_that_is_repaired_while_its_finger_is_on_a_key_presses_nothing() {
    let press = Press::for_text("h");
    let loaded = default_setup();
    let map = &loaded.glove.as_ref().expect("a glove").map;
    let of_index = |channel: &usize| map.fingers_affected_by(*channel).contains(Finger::Index);
    let channels = map.rows().iter().map(|row| row.channel);
    let channels: Vec<usize> = channels.filter(of_index).collect();
    assert!(channels.len() >= 3, "{channels:?}");
    for channel in channels {
        let mut random = fastrand::Rng::with_seed(channel as u64);
        let mut wearer = GloveWearer::new(&loaded);
        wearer.play(&[press.clear(); 60]);
        wearer.play(&loose(&[press.clear(); 350], channel, &mut random));
        wearer.play(&loose(&press.approach, channel, &mut random));
        wearer.play(&[press.pressed(); 400]);
        assert_eq!(wearer.take_events(), "", "channel {channel}");
        wearer.play(&press.lift);
        wearer.play(&press.approach);
        assert_eq!(wearer.take_events(), "down H", "channel {channel}");
    }
}

#[test]
fn a_key_that_the_angle_of_the_wrist_holds_is_released_when_its_sensor_jumps() {
    const WRIST: usize = 4;
    let press = Press::for_text("h");
    let mut loaded = default_setup();
    let text = r#"Layout(name: "a", triggers: [(name: "Bow", action: Key("A"),
        when: Angle(dof: "wrist-flexion", on_deg: 20, off_deg: 10))])"#;
    loaded.layout = Layout::parse(text, "a.ron").expect("a layout");
    let mut wearer = GloveWearer::new(&loaded);
    let bend: Vec<Posture> = (60..=141)
        .step_by(3)
        .map(|count| with(&press.clear(), WRIST, count))
        .collect();
    wearer.play(&[bend[0]; 100]);
    wearer.play(&bend);
    // 40°, and then in each second reading something else.
    let bent = bend[bend.len() - 1];
    wearer.play(&[bent; 50]);
    assert_eq!(wearer.take_events(), "down A");
    let mut random = fastrand::Rng::with_seed(1);
    let half = (0..700).map(|number| match number % 2 {
        0 => bent,
        _ => with(&bent, WRIST, random.u8(..60)),
    });
    wearer.play(&half.collect::<Vec<_>>());
    assert_eq!(wearer.take_events(), "up A");
    let right = wearer.pipeline.implausible()[Side::Right.index()];
    assert!(right.angles.contains(Dof::WristFlexion));
    // The same angle is a new movement.
    wearer.play(&[bent; 400]);
    assert_eq!(wearer.take_events(), "");
    let mut back = bend.clone();
    back.reverse();
    wearer.play(&back);
    wearer.play(&[bend[0]; 50]);
    wearer.play(&bend);
    wearer.play(&[bent; 50]);
    assert_eq!(wearer.take_events(), "down A");
}
