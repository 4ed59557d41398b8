#![no_main]
libfuzzer_sys::fuzz_target!(|data: &[u8]| strokefit_fuzz::scene(data));
