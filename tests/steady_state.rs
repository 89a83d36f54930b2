//! After the start, the way from bytes to events allocates nothing.
#![allow(
    unsafe_code,
    reason = "a global allocator can only be written as unsafe code"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use ademan::capture::hc11::{Decoder, Framing, encode};
use ademan::capture::{Channels, LineSettings, Reading, Sample};
use ademan::device::Events;
use ademan::lab::Typist;
use ademan::settings::Setup;
use ademan::time::Timestamp;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    ALLOCATIONS.with(|allocations| allocations.set(allocations.get() + 1));
}

// SAFETY: everything is passed on to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

/// The bytes of a glove that types.
fn stream(mut typist: Typist) -> Vec<u8> {
    let mut bytes = Vec::new();
    while let Some(counts) = typist.next_counts() {
        let mut body = [0; 64];
        for (byte, count) in body.iter_mut().zip(counts) {
            *byte = count as u8;
        }
        bytes.extend(encode(Framing::Double06, &body));
    }
    bytes
}

#[test]
fn a_frame_allocates_nothing_from_its_bytes_to_its_events() {
    let assembly = Setup::default()
        .assemble()
        .expect("the default setup is there");
    let text = "Steady State!";
    let typist = assembly.typist(text, &LineSettings::default(), 0.5, 7);
    let bytes = stream(typist.expect("the text can be typed"));
    let mut pipeline = assembly.pipeline();
    let mut decoder = Decoder::new(Framing::Double06);
    let mut events = Events::new();
    let (mut frames, mut sent) = (0, 0);

    let before = allocations();
    for piece in bytes.chunks(29) {
        decoder.push(piece, &mut |body| {
            frames += 1;
            let reading = Reading {
                time: Timestamp(5_729 * frames),
                sample: Sample::Channels(Channels {
                    full_scale: 255,
                    counts: body.iter().map(|byte| u16::from(*byte)).collect(),
                }),
            };
            events.clear();
            let _ = std::hint::black_box(pipeline.step(&reading, &mut events));
            sent += events.len();
        });
    }
    pipeline.stop(&mut events);
    let allocated = allocations() - before;

    assert_eq!(pipeline.accepted(), frames);
    // Down and up for every key and every Shift, so that the whole way was in use.
    assert_eq!(sent, 2 * (text.len() + 3));
    assert_eq!(allocated, 0, "{allocated} allocations in {frames} frames");
    drop(std::hint::black_box(Box::new(0)));
    assert!(allocations() > before, "the allocator counts");
}
