//! Seeds that are valid up to one exaggeration: deep nesting, lengths that lie, numbers at the limits of their types.
//!
//! Damage of ordinary seeds rarely reaches these: a size field and the bytes that it promises would have to change together.

use mcap::records::op;

/// Returns layouts: deep, long or repeated where the schema permits it.
pub fn layouts() -> Vec<Vec<u8>> {
    let board = r#"(pose: (anchor: elbow, bearing_deg: 35, forward_mm: 310), rows: [(at_mm: (0, 0), keys: "Q W E")])"#;
    let layout = |boards: &str| format!(r#"Layout(name: "a", boards: [{boards}])"#);
    let key = |text: &str| {
        let keys = format!(r#"rows: [], keys: [(text: "{text}", at_mm: (0, 0))]"#);
        layout(&board.replace(r#"rows: [(at_mm: (0, 0), keys: "Q W E")]"#, &keys))
    };
    let fields: String = (0..2_000)
        .map(|index| format!("field_{index}: 0,"))
        .collect();
    [
        layout(""),
        layout(&[board; 300].join(",")),
        layout(&format!("{board},{board}")),
        layout(&board.replace("310", "1e308")),
        layout(&board.replace("310", "-0.0")),
        layout(&board.replace("310", "9223372036854775808")),
        layout(&board.replace("310", "NaN")),
        key("n"),
        key(&"a".repeat(5_000)),
        key("\\u{202e}\\u{0}\\n\\u{9b}2J"),
        key(&"\u{1f468}\u{200d}".repeat(200)),
        format!("{}{}", "/*".repeat(500), "*/".repeat(500)),
        format!("#![enable({})]", ["implicit_some"; 400].join(",")),
        format!(
            "Layout(name: {}None{})",
            "Some(".repeat(120),
            ")".repeat(120)
        ),
        format!(
            r##"Layout(name: r{0}"{1}"{0}, boards: [])"##,
            "#".repeat(250),
            "x".repeat(2_000)
        ),
        format!("Layout({fields})"),
    ]
    .map(String::into_bytes)
    .into()
}

/// Returns datagrams of Open Sound Control with sizes that lie, after the length of the pieces that they arrive in.
pub fn osc() -> Vec<Vec<u8>> {
    let message = |address: &[u8], types: &[u8], arguments: &[u8]| {
        [padded(address), padded(types), arguments.to_vec()].concat()
    };
    let floats = |number: f32| [number.to_be_bytes(); 7].concat();
    let bone = |name: &[u8], number| {
        let arguments = [padded(name), floats(number)].concat();
        message(b"/VMC/Ext/Bone/Pos", b",sfffffff", &arguments)
    };
    let ok = message(b"/VMC/Ext/OK", b",i", &1_i32.to_be_bytes());
    let nested = (0..40).fold(ok.clone(), |inner, _| bundle(&[&inner]));
    let lying = |size: i32| {
        [
            &b"#bundle\0\0\0\0\0\0\0\0\x01"[..],
            &size.to_be_bytes(),
            &ok,
        ]
        .concat()
    };
    let mut datagrams = vec![
        bundle(&[]),
        nested,
        bundle(&vec![&ok[..]; 500]),
        bundle(&[
            &bone(b"LeftHand", f32::NAN),
            &bone(b"LeftHand", f32::INFINITY),
            &ok,
        ]),
        bundle(&[&bone(&[b'x'; 4_000], 1.0), &bone(b"", 0.0), &ok]),
        message(b"/VMC/Ext/Bone/Pos", &[b'f'; 3_000], &floats(1.0)),
        message(b"/VMC/Ext/T", b",f", b""),
        message(b"/VMC/Ext/OK", b"", b""),
        vec![b'/'; 1_999],
        padded(b"#bundle"),
    ];
    datagrams.extend([-1, i32::MIN, i32::MAX, 0, 3, 5].map(lying));
    datagrams
        .iter()
        .map(|datagram| [&[9][..], datagram].concat())
        .collect()
}

/// Returns a bundle of Open Sound Control.
fn bundle(elements: &[&[u8]]) -> Vec<u8> {
    let mut bytes = b"#bundle\0\0\0\0\0\0\0\0\x01".to_vec();
    for element in elements {
        bytes.extend((element.len() as u32).to_be_bytes());
        bytes.extend(*element);
    }
    bytes
}

/// Returns a string of Open Sound Control: a zero byte ends it, and its length is a multiple of four.
fn padded(text: &[u8]) -> Vec<u8> {
    let mut bytes = [text, b"\0"].concat();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

/// Returns motion capture texts, after the length of the pieces that they arrive in.
pub fn bvh() -> Vec<Vec<u8>> {
    let joint = |name: &str, inner: &str| {
        format!(
            "JOINT {name}\n{{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n{inner}}}\n"
        )
    };
    let file = |joints: &str, frames: &str, motion: &str| {
        format!(
            "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n{joints}}}\nMOTION\n\
            Frames: {frames}\nFrame Time: 0.01\n{motion}"
        )
    };
    let deep = |levels: usize| {
        (0..levels).fold(String::new(), |inner, level| {
            joint(&format!("j{level}"), &inner)
        })
    };
    let hand = joint("RightHand", "");
    let line = |numbers: usize| format!("{}\n", "1 ".repeat(numbers));
    let texts = [
        file(&deep(60), "1", &line(183)),
        file(&deep(300), "1", &line(903)),
        file(&hand.repeat(50), "1", &line(153)),
        file(&joint(&"R".repeat(10_000), ""), "1", &line(6)),
        file(&hand, "18446744073709551615", &line(6)),
        file(&hand, "-1", &line(6)),
        file(&hand, "0", ""),
        file(&hand, "2", "1e999 NaN inf -inf 1e-400 .\n1 2 3 4 5 6"),
        file(&hand, "3", &line(50)),
        file(
            &hand.replace("OFFSET 0 1 0", "OFFSET 1e308 1e308 1e308"),
            "1",
            &line(6),
        ),
        file(
            &hand.replace("CHANNELS 3", "CHANNELS 4294967297"),
            "1",
            &line(6),
        ),
        file(
            &hand.replace("CHANNELS 3 Zrotation", "CHANNELS 3 Yrotation"),
            "1",
            &line(6),
        ),
        "HIERARCHY ".repeat(500),
    ];
    let seed = |text: &String| std::iter::once(13).chain(text.bytes()).collect();
    texts.iter().map(seed).collect()
}

/// Returns recordings with a length that lies in one of their records, and one with all records twice.
pub fn recordings(valid: &[u8]) -> Vec<Vec<u8>> {
    const LENGTHS: [u64; 4] = [0, 1, u32::MAX as u64, u64::MAX];
    /// The position of the uncompressed size of a chunk: two times and the header of the record are before it.
    const CHUNK_SIZE: usize = 25;
    let with_number = |at: usize, number: u64| {
        let mut bytes = valid.to_vec();
        bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
        bytes
    };
    let mut seeds = vec![valid.repeat(2)];
    for (start, length) in record_starts(valid)
        .into_iter()
        .zip(LENGTHS.into_iter().cycle())
    {
        seeds.push(with_number(start + 1, length));
        if valid[start] == op::CHUNK {
            seeds.push(with_number(start + CHUNK_SIZE, u64::MAX));
        }
    }
    seeds
}

/// Returns the positions of the records of a valid recording.
fn record_starts(bytes: &[u8]) -> Vec<usize> {
    const MAGIC_BYTES: usize = 8;
    let mut starts = Vec::new();
    let mut at = MAGIC_BYTES;
    while at + 9 + MAGIC_BYTES <= bytes.len() {
        starts.push(at);
        let length = bytes[at + 1..at + 9].try_into().expect("eight bytes");
        at += 9 + u64::from_le_bytes(length) as usize;
    }
    starts
}
