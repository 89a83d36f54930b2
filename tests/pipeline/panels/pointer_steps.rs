//! A pointer in the hands of chance: its steps stay within bounds and nothing stays down.

use super::rig::Rig;

/// The most that each frame moves the cursor, in pixels.
const MOST: f64 = 50.0;
/// The last pixel of the screen.
const LAST: [f64; 2] = [1000.0, 500.0];

const MODES: [&str; 5] = [
    r#"Joint(
        x: (dof: "wrist-deviation", from_deg: -10, to_deg: 10),
        y: (dof: "wrist-flexion", from_deg: 30, to_deg: -30, curve: 0.3),
    )"#,
    "Direct(place: (anchor: wrist, tilt_deg: 40, bearing_deg: -70), size_mm: (100, 50, 50))",
    "Ray(from: Index, place: (anchor: elbow, forward_mm: 100), size_mm: (100, 50))",
    "Ray(from: Hand, place: (anchor: elbow, bearing_deg: 20, forward_mm: 100), size_mm: (100, 50))",
    "Rate(of: Tip(place: (anchor: world), full_mm: 50), dead_share: 0, top_px_s: 100000, curve: 0.2)",
];
const WAYS: [&str; 4] = [
    "moves: To, smoothing: Default",
    "moves: To, dead_zone_px: 3, precision: Flexion(\"ring-pip-flexion\", 20)",
    "moves: By, acceleration: [(10, 0.1), (1000, 20)], scroll: (by: Pinch(\"ring\"), px_per_click: -7)",
    "moves: By, clutch: Pinch(\"ring\")",
];

/// Knuth's MMIX generator; its high bits are the good ones.
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }

    fn number(&mut self, reach: i64) -> String {
        match self.below(40) {
            0 => "NaN".into(),
            1 => "inf".into(),
            2 => "-1e38".into(),
            3 => "1e-42".into(),
            _ => (self.below(2 * reach as usize) as i64 - reach).to_string(),
        }
    }

    fn order(&mut self) -> String {
        let finger = ["thumb", "index", "middle", "ring"];
        let dof = ["wrist-deviation", "wrist-flexion", "ring-pip-flexion"];
        match self.below(30) {
            0 => format!("lost:{}", self.of(&finger)),
            1 => format!("doubt:{}", self.of(&finger)),
            2..5 => "trust:index".into(),
            5 => "jump".into(),
            6 => "release".into(),
            7..12 => format!("angle:{}={}", self.of(&dof), self.number(40)),
            12..14 => format!("palm={},0,0", self.number(90)),
            14..17 => format!("knuckle={},0,90", self.number(40)),
            _ => {
                let place = [(); 3].map(|()| self.number(60)).join(",");
                format!("tip:{}={place}", self.of(&finger))
            }
        }
    }
}

/// Checks one line of a transcript; returns whether it moved the cursor.
fn check(event: &str, told: &mut Option<[f64; 2]>, down: &mut Vec<String>) -> bool {
    let words: Vec<&str> = event.split_whitespace().collect();
    let number = |place: usize| words[place].parse::<f64>().expect("a number");
    match words[0] {
        "place" => {
            let shares = [number(1), number(2)];
            assert!(shares.iter().all(|it| (0.0..=1.0).contains(it)), "{event}");
            let place = [shares[0] * LAST[0], shares[1] * LAST[1]];
            if let Some(before) = told.replace(place) {
                let step = (place[0] - before[0]).hypot(place[1] - before[1]);
                // The transcript has four decimals.
                assert!(step <= MOST + 0.2, "{event} is {step} px");
            }
            true
        }
        "move" => {
            assert!(number(1).hypot(number(2)) <= MOST, "{event}");
            true
        }
        "down" => {
            assert!(!down.contains(&words[1].into()), "{event}");
            down.push(words[1].into());
            false
        }
        "up" => {
            let place = down.iter().position(|it| it == words[1]);
            down.remove(place.expect("what comes up was down"));
            false
        }
        "scroll" => false,
        _ => panic!("{event}"),
    }
}

#[test]
fn whatever_the_hand_does_steps_are_bounded_places_on_the_screen_and_nothing_stays_down() {
    let mut chance = Chance(3);
    let (mut moved, mut pressed) = (0, 0);
    for mode in MODES {
        for way in WAYS {
            let smoothing = if way.contains("smoothing") {
                ""
            } else {
                "smoothing: Off, "
            };
            let fields = format!(
                "mode: {mode}, {smoothing}{way}, max_step_px: {MOST}, screen_px: (1001, 501), \
                 clicks: [(by: Pinch(\"index\"), does: Key(\"MouseLeft\")), \
                 (by: Push(10), does: Key(\"MouseRight\"))], \
                 dwell: (ms: 50, radius_px: 5, does: Key(\"MouseMiddle\"))"
            );
            let layout = format!("Layout(name: \"test\", pointer: Pointer({fields}))");
            let mut rig = Rig::new(&layout);
            let orders: Vec<String> = (0..4_000)
                .map(|_| format!("{}&{}", chance.order(), chance.order()))
                .collect();
            rig.run(&orders.join(" ")).run("release");
            let (mut told, mut down) = (None, Vec::new());
            for line in rig.transcript().lines() {
                moved += usize::from(check(&line[13..], &mut told, &mut down));
                pressed += usize::from(line.contains(" down "));
            }
            assert!(down.is_empty(), "{down:?} stay down: {fields}");
        }
    }
    assert!(
        moved > 5_000 && pressed > 500,
        "{moved} motions, {pressed} presses"
    );
}
