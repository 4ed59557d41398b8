#![no_main]
// A panic of resvg is an error of ours: libFuzzer is not to end the program for it.
libfuzzer_sys::fuzz_target!(init: strokefit::verify::silence_panics(), |data: &[u8]| strokefit_fuzz::svg(data));
