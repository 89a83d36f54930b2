#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    ademan_fuzz::secure::handshake(data);
});
