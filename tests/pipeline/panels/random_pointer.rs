//! A pointer under random motion: its steps are bounded, and no button stays pressed.

use crate::rig::Rig;

/// Maximum motion of the cursor per step, in pixels.
const MAX_STEP: f64 = 50.0;
/// The last pixel of the screen.
const LAST: [f64; 2] = [1000.0, 500.0];

const MODES: [&str; 6] = [
    r#"Joint(
        x: (dof: "wrist-deviation", from_deg: -10, to_deg: 10),
        y: (dof: "wrist-flexion", from_deg: 30, to_deg: -30, exponent: 0.3),
    )"#,
    "Direct(pose: (anchor: wrist, tilt_deg: 40, bearing_deg: -70), size_mm: (100, 50, 50))",
    "Ray(origin: Index, pose: (anchor: elbow, forward_mm: 100), size_mm: (100, 50))",
    "Ray(origin: Hand, pose: (anchor: elbow, bearing_deg: 20, forward_mm: 100), size_mm: (100, 50))",
    "Rate(input: Fingertip(pose: (anchor: world), full_mm: 50), dead_zone: 0, max_px_per_s: 100000, exponent: 0.2)",
    "Direct(point: Knuckle, pose: (anchor: elbow, forward_mm: -90), size_mm: (100, 50, 50))",
];
const SETTINGS: [&str; 4] = [
    "output: Absolute, smoothing: Default",
    "output: Absolute, dead_zone_px: 3, precision: Flexion(\"ring-pip-flexion\", 20)",
    "output: Relative, acceleration: [(10, 0.1), (1000, 20)], scroll: (gesture: Pinch(\"ring\"), px_per_detent: -7)",
    "output: Relative, clutch: Pinch(\"ring\")",
];

/// A generator of script orders for a hand that moves at random.
struct RandomHand(fastrand::Rng);

impl RandomHand {
    fn one_of<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.0.usize(..words.len())]
    }

    fn number(&mut self, limit: i32) -> String {
        match self.0.u8(..40) {
            0 => "NaN".into(),
            1 => "inf".into(),
            2 => "-1e38".into(),
            3 => "1e-42".into(),
            _ => self.0.i32(-limit..limit).to_string(),
        }
    }

    fn order(&mut self) -> String {
        let finger = ["thumb", "index", "middle", "ring"];
        let dof = ["wrist-deviation", "wrist-flexion", "ring-pip-flexion"];
        match self.0.u8(..30) {
            0 => format!("hide {}", self.one_of(&finger)),
            1 => format!("doubt {}", self.one_of(&finger)),
            2..5 => "trust index".into(),
            5 => "reacquire".into(),
            6 => "release".into(),
            7..12 => format!("set {} {}", self.one_of(&dof), self.number(40)),
            12..14 => format!("palm {} 0 0", self.number(90)),
            14..17 => format!("knuckle {} 0 90", self.number(40)),
            _ => {
                let position = [(); 3].map(|()| self.number(60)).join(" ");
                format!("tip {} {position}", self.one_of(&finger))
            }
        }
    }
}

/// The state of cursor and buttons according to the transcript.
#[derive(Default)]
struct Screen {
    cursor_px: Option<[f64; 2]>,
    pressed: Vec<String>,
    motions: usize,
    presses: usize,
}

impl Screen {
    /// Checks one word of a transcript.
    fn check(&mut self, word: &str) {
        if let Some(position) = word.strip_prefix("place=") {
            self.motions += 1;
            let fractions = pair(position);
            let is_on_screen = fractions.iter().all(|it| (0.0..=1.0).contains(it));
            assert!(is_on_screen, "{word}");
            let cursor = [fractions[0] * LAST[0], fractions[1] * LAST[1]];
            if let Some(before) = self.cursor_px.replace(cursor) {
                let step = (cursor[0] - before[0]).hypot(cursor[1] - before[1]);
                // The transcript has four decimals.
                assert!(step <= MAX_STEP + 0.2, "{word} is {step} px");
            }
        } else if let Some(motion) = word.strip_prefix("move=") {
            self.motions += 1;
            let [x, y] = pair(motion);
            assert!(x.hypot(y) <= MAX_STEP, "{word}");
        } else if let Some(button) = word.strip_prefix("dn:") {
            self.presses += 1;
            assert!(!self.pressed.iter().any(|it| it == button), "{word}");
            self.pressed.push(button.into());
        } else if let Some(button) = word.strip_prefix("up:") {
            let index = self.pressed.iter().position(|it| it == button);
            self.pressed
                .remove(index.expect("only a pressed button is released"));
        } else {
            assert!(word.starts_with("scroll="), "{word}");
        }
    }
}

fn pair(text: &str) -> [f64; 2] {
    let (x, y) = text.split_once(',').expect("two numbers");
    [x, y].map(|number| number.parse().expect("a number"))
}

#[test]
fn random_hands_move_the_pointer_in_bounded_steps_and_leave_no_key_down() {
    let mut hand = RandomHand(fastrand::Rng::with_seed(3));
    let (mut motions, mut presses) = (0, 0);
    for mode in MODES {
        for settings in SETTINGS {
            let smoothing = if settings.contains("smoothing") {
                ""
            } else {
                "smoothing: Off, "
            };
            let fields = format!(
                "mode: {mode}, {smoothing}{settings}, max_step_px: {MAX_STEP}, screen_px: (1001, 501), \
                 clicks: [(gesture: Pinch(\"index\"), action: Key(\"MouseLeft\")), \
                 (gesture: Push(10), action: Key(\"MouseRight\"))], \
                 dwell: (time_ms: 50, radius_px: 5, action: Key(\"MouseMiddle\"))"
            );
            let layout = format!("Layout(name: \"test\", pointer: Pointer({fields}))");
            let mut rig = Rig::new(&layout);
            let steps: Vec<String> = (0..4_000)
                .map(|_| format!("{} & {}", hand.order(), hand.order()))
                .collect();
            rig.run(&steps.join("; ")).run("release");
            let mut screen = Screen::default();
            let events = rig.events();
            events
                .split_whitespace()
                .for_each(|word| screen.check(word));
            motions += screen.motions;
            presses += screen.presses;
            let pressed = screen.pressed;
            assert!(pressed.is_empty(), "{pressed:?} stay down: {fields}");
        }
    }
    assert!(
        motions > 5_000 && presses > 500,
        "{motions} motions, {presses} presses"
    );
}
