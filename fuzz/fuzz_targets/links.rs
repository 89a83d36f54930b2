#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    ademan_fuzz::texts::layout_link(data);
});
