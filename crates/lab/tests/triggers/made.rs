//! Shapes and motions that people make in front of a noisy camera and with a glove: each is recognized, and others are not.

use super::*;

/// The bends of a hand at rest, and of its fingers as a person makes a shape: not exactly as others do.
fn shape_bends(shape: HandShape, draw: &mut Draw) -> [f64; Finger::COUNT] {
    std::array::from_fn(|index| match shape.bend(Finger::ALL[index]) {
        Some(bend) if bend > 0.5 => draw.between(0.75, 0.95),
        Some(_) => draw.between(0.0, 0.1),
        None => draw.between(0.2, 0.7),
    })
}

/// The time of a movement to a shape, and until the shape is left.
const MOVE: f64 = 0.3;
const SHOWN: f64 = 2.5;

/// The bend of a finger before the shape: an open hand follows a closed one.
fn bend_before(shape: HandShape) -> f64 {
    if shape == HandShape::OpenHand {
        0.75
    } else {
        0.4
    }
}

/// Returns the bend of each finger at a time, from a relaxed hand to a shape.
fn bends_at(seconds: f64, before: f64, shape: &[f64; Finger::COUNT]) -> [f64; Finger::COUNT] {
    let fraction = ((seconds - 1.0) / MOVE).clamp(0.0, 1.0);
    shape.map(|bend| before + fraction * (bend - before))
}

/// Checks that a shape turned on its trigger once, in time, and no other one.
fn check_detection(rig: &Rig, name: &str, hold: Duration, what: &str) {
    let is_later = |times: &Vec<Timestamp>| times.iter().any(|time| time.seconds() > 1.0);
    let later = rig.on.iter().filter(|(_, times)| is_later(times));
    assert_eq!(
        later.map(|(seen, _)| seen).collect::<Vec<_>>(),
        [name],
        "{what}"
    );
    assert_eq!(rig.count(name), 1, "{what}");
    let seconds = rig.on[name][0].seconds() - 1.0 - hold.as_secs_f64();
    // The trigger may see the shape before its end, sensors are late, and noise may restart the hold time.
    assert!(
        (0.0..=MOVE + 0.3).contains(&seconds),
        "{what}: {seconds} s late"
    );
}

fn hold(name: &str) -> Duration {
    let layout = layout(&[]);
    let trigger = layout.triggers.iter().find(|(own, _)| own == name);
    trigger.expect("a trigger").1.hold
}

#[test]
fn people_with_other_bones_in_front_of_a_noisy_camera_make_every_shape() {
    for person in population(&People::Drawn(6), None, 98) {
        for &side in Side::ALL {
            for (shape, name) in SHAPES {
                let assumed = ArmModel::anthropometric(side, &person.assumed).expect("an arm");
                let own = ArmModel::anthropometric(side, &person.own).expect("an arm");
                let mut draw = Draw::new(person.seed, shape.index() as u64);
                let shown = shape_bends(shape, &mut draw);
                let mut rig = Rig::new(&[assumed], &[], true);
                for number in 0..(rate(&person) * SHOWN) as u64 {
                    let seconds = number as f64 / rate(&person);
                    let angles = angles_of(&bends_at(seconds, bend_before(shape), &shown));
                    let time = Timestamp::from_seconds(seconds);
                    let mut positions = own.forward(&Estimate::new(time, angles)).positions();
                    for (joint, position) in positions.clone().known() {
                        let noise = DVec3::new(draw.normal(), draw.normal(), 3.0 * draw.normal());
                        positions.set(joint, position + noise * 1e-3);
                    }
                    let sample = Sample::Joints { positions };
                    rig.see(&Reading::new(time, Some(side), sample));
                }
                let what = format!("{shape} of person {} {side}", person.number);
                check_detection(&rig, name, hold(name), &what);
            }
        }
    }
}

/// The positions of a hand whose palm makes a motion in front of a noisy camera, and what its triggers do.
fn moved(arm: &ArmModel, hertz: f64, draw: &mut Draw, way: impl Fn(f64) -> DVec3) -> Rig {
    let mut rig = Rig::new(std::slice::from_ref(arm), &[], true);
    let bends = |_: f64| [0.3; Finger::COUNT];
    let times = (0..(hertz * SHOWN) as u64).map(|number| number as f64 / hertz);
    show(&mut rig, arm, times, draw, bends, way);
    rig
}

#[test]
fn people_in_front_of_a_noisy_camera_swipe_in_every_direction_and_shake() {
    for person in population(&People::Drawn(6), None, 98) {
        for &side in Side::ALL {
            let arm = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 17);
            for (direction, name) in [
                (DVec3::NEG_X, "Next"),
                (DVec3::X, "Back"),
                (DVec3::Y, "Louder"),
                (DVec3::NEG_Y, "Quieter"),
            ] {
                let (far, time) = (draw.between(0.3, 0.4), draw.between(0.25, 0.4));
                let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                    direction * far * minimum_jerk(seconds / time)
                });
                let what = format!("{name} of person {} {side}", person.number);
                check_detection(&rig, name, Duration::ZERO, &what);
            }
            let (half, hertz) = (draw.between(0.07, 0.1), draw.between(2.5, 3.2));
            let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                let phase = seconds.max(0.0) * hertz * std::f64::consts::TAU;
                DVec3::X * half * phase.sin()
            });
            assert_eq!(rig.count("Shake"), 1, "person {} {side}", person.number);
        }
    }
}

#[test]
fn people_in_front_of_a_noisy_camera_draw_circles_upright_and_flat() {
    for person in population(&People::Drawn(20), None, 99) {
        for &side in Side::ALL {
            let arm = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 18);
            for (name, other, sense) in [
                ("Circle", "Circle back", 1.0),
                ("Circle back", "Circle", -1.0),
            ] {
                // Wide or high by a fifth, tilted backwards by up to a quarter turn, and begun anywhere.
                let (radius, time) = (draw.between(0.05, 0.14), draw.between(0.6, 1.3));
                let (wide, begin) = (draw.between(0.8, 1.2), draw.between(0.0, 6.2));
                let tilt = draw.between(0.0, std::f64::consts::FRAC_PI_2);
                let at = |angle: f64| {
                    let (right, up) = (wide * angle.sin() * sense, angle.cos());
                    radius * DVec3::new(right, up * tilt.cos(), -up * tilt.sin())
                };
                let rig = moved(&arm, rate(&person), &mut draw, |seconds| {
                    let done = minimum_jerk(seconds / time);
                    at(begin + done * std::f64::consts::TAU) - at(begin)
                });
                let what = format!("{name} of person {} {side}: {:?}", person.number, rig.on);
                assert_eq!(rig.count(name), 1, "{what}");
                assert_eq!(rig.count("Fingertip circle"), 1, "{what}");
                assert_eq!(rig.count(other), 0, "{what}");
            }
        }
    }
}

#[test]
fn a_hand_that_goes_half_round_or_draws_a_square_makes_no_circle() {
    for person in population(&People::Drawn(6), None, 99) {
        let arm = ArmModel::anthropometric(Side::Right, &person.own).expect("an arm");
        let mut draw = Draw::new(person.seed, 19);
        let radius = draw.between(0.06, 0.12);
        let half = moved(&arm, rate(&person), &mut draw, |seconds| {
            let (sine, cosine) = (minimum_jerk(seconds / 0.6) * 3.1).sin_cos();
            radius * DVec3::new(sine, cosine, 0.0)
        });
        let corners = [DVec3::ZERO, DVec3::X, DVec3::ONE - DVec3::Z, DVec3::Y];
        let square = moved(&arm, rate(&person), &mut draw, |seconds| {
            let side = (seconds / 0.3).clamp(0.0, 3.999);
            let [from, to] = [side as usize, (side as usize + 1) % 4].map(|it| corners[it]);
            2.0 * radius * from.lerp(to, minimum_jerk(side.fract()))
        });
        for rig in [half, square] {
            let circles = ["Circle", "Circle back", "Fingertip circle"].map(|it| rig.count(it));
            assert_eq!(circles, [0; 3], "person {}: {:?}", person.number, rig.on);
        }
    }
}

#[test]
fn a_fist_that_opens_in_time_is_a_sequence() {
    let layout = layout(&[SEQUENCES]);
    let name = "Fist, open hand";
    for person in population(&People::Drawn(10), None, 98) {
        for &side in Side::ALL {
            let assumed = ArmModel::anthropometric(side, &person.assumed).expect("an arm");
            let own = ArmModel::anthropometric(side, &person.own).expect("an arm");
            let mut draw = Draw::new(person.seed, 20);
            let [fist, open] =
                [HandShape::Fist, HandShape::OpenHand].map(|shape| shape_bends(shape, &mut draw));
            let (closing, opening) = (draw.between(0.15, 0.4), draw.between(0.15, 0.4));
            let held = draw.between(0.3, 1.2);
            // A hand that rests half open for longer than a second between the two makes no sequence.
            for (rest, expected) in [(0.0, 1), (1.6, 0)] {
                let bends = |seconds: f64| {
                    let close = minimum_jerk((seconds - 1.0) / closing);
                    let since = seconds - 1.0 - closing - held;
                    let relax = if rest > 0.0 {
                        minimum_jerk(since / opening)
                    } else {
                        0.0
                    };
                    let spread = minimum_jerk((since - rest) / opening);
                    std::array::from_fn(|it| {
                        let bend = 0.4 + close * (fist[it] - 0.4);
                        let bend = bend + relax * (0.35 - bend);
                        bend + spread * (open[it] - bend)
                    })
                };
                let mut rig = Rig::of(&layout, std::slice::from_ref(&assumed), &[], true);
                let times = (0..(rate(&person) * 6.0) as u64).map(|it| it as f64 / rate(&person));
                show(&mut rig, &own, times, &mut draw, bends, |_| DVec3::ZERO);
                let what = format!("person {} {side}, {rest} s: {:?}", person.number, rig.on);
                assert_eq!(rig.count(name), expected, "{what}");
                assert_eq!(rig.count("Short fist"), 1, "{what}");
            }
        }
    }
}

#[test]
fn a_glove_with_five_curls_makes_every_shape_on_either_hand() {
    for (side, glove) in [
        (Side::Right, "lucidgloves"),
        (Side::Left, "lucidgloves-left"),
    ] {
        for (shape, name) in SHAPES {
            let mut draw = Draw::new(7, shape.index() as u64);
            let shown = shape_bends(shape, &mut draw);
            let mut rig = Rig::new(&[arm(side)], &[glove], false);
            let mut decoder = (lucidgloves::PROTOCOL.decoder)(&Default::default());
            for number in 0..(100.0 * SHOWN) as u64 {
                let seconds = number as f64 / 100.0;
                let counts = bends_at(seconds, bend_before(shape), &shown).map(|bend| {
                    let noise = 20.0 * draw.normal();
                    (bend * 4095.0 + noise).clamp(0.0, 4095.0).round()
                });
                let [thumb, index, middle, ring, little] = counts;
                let line = format!("A{thumb}B{index}C{middle}D{ring}E{little}\n");
                decoder.push(line.as_bytes(), &mut |packet| {
                    let time = Timestamp::from_seconds(seconds);
                    rig.see(&Reading::new(time, Some(side), packet.sample));
                });
            }
            check_detection(&rig, name, hold(name), &format!("{shape} {side}"));
        }
    }
}
