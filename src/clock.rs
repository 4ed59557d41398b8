//! The clock. The one door of `web-time`.
//!
//! WebAssembly in a browser has no clock of its own: there the page's is asked.

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub use std::time::Instant;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub use web_time::Instant;
