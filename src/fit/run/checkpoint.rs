//! Checkpoint files, from which a fit that was cut off goes on to the same bytes.
//!
//! A checkpoint holds the whole state of a fit, all numbers to the last bit. Its head has the version of the format, a
//! fingerprint of picture and configuration, and a checksum. It is written under another name and then renamed, so that
//! a complete file exists at any moment. The times at which it is written do not influence the drawing. Only this module
//! uses `cbor4ii`.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::clock::Instant;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::base::Base;
use crate::fit::config::Config;
use crate::fit::drawing::focus::Focus;
use crate::image::Image;

/// The first bytes of every checkpoint; the number counts the released layouts.
const MAGIC: &[u8; 24] = b"strokefit checkpoint 05\n";
/// Length of the head, bytes: magic, fingerprint and checksum.
const HEAD: usize = MAGIC.len() + 8 + 8;

/// Default time between two writes.
const EVERY: Duration = Duration::from_secs(10);
/// Writes take at most one part in this many of the time.
const MAX_SHARE: u32 = 20;

/// A file that keeps the state of a fit, so that the fit can be resumed after it was cut off.
///
/// If the file exists, the fit goes on from it. The file stays when the fit ends: [`remove`](Self::remove) it once the
/// drawing is saved.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    every: Duration,
    /// Time of the next write.
    due: Instant,
    trouble: Option<Error>,
}

impl Checkpoint {
    /// A checkpoint in the file `path`, which need not exist.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            every: EVERY,
            due: Instant::now(),
            trouble: None,
        }
    }

    /// Sets the time between two writes, 10 s by default. If a write takes longer than a twentieth of that, writes are
    /// less frequent.
    #[must_use]
    pub fn every(self, span: Duration) -> Self {
        Self {
            every: span,
            ..self
        }
    }

    /// Removes the file, if there is one.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when it cannot be removed.
    pub fn remove(&self) -> Result<()> {
        match fs::remove_file(&self.path) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => {
                let message = format!("{}: cannot be removed ({cause})", self.path.display());
                Err(Error::new(ErrorKind::Io, message).caused_by(cause))
            }
            _ => Ok(()),
        }
    }

    /// Why the last write failed, if it did. The fit goes on all the same.
    pub fn trouble(&self) -> Option<&Error> {
        self.trouble.as_ref()
    }

    /// True if the file is intact and of the fit with this fingerprint.
    pub(in crate::fit) fn is_of(&self, fingerprint: u64) -> bool {
        fs::read(&self.path).is_ok_and(|bytes| self.payload(&bytes, fingerprint).is_ok())
    }

    /// The state that the file holds, which must be of the fit with this fingerprint; `None` if there is no file.
    pub(in crate::fit) fn load<T: DeserializeOwned>(&self, fingerprint: u64) -> Result<Option<T>> {
        let bytes = match fs::read(&self.path) {
            Ok(bytes) => bytes,
            Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(cause) => {
                let refusal = self.refusal(ErrorKind::Io, &format!("cannot be read ({cause})"));
                return Err(refusal.caused_by(cause));
            }
        };
        let payload = self.payload(&bytes, fingerprint)?;
        let state = coding::decoded(payload).map_err(|cause| self.damaged().caused_by(cause))?;
        Ok(Some(state))
    }

    /// The bytes after the head, if the file is intact and of the fit with this fingerprint.
    fn payload<'a>(&self, bytes: &'a [u8], fingerprint: u64) -> Result<&'a [u8]> {
        let foreign =
            "is no checkpoint of this version of strokefit: name another file, or remove it";
        if !bytes.starts_with(MAGIC) {
            return Err(self.refusal(ErrorKind::Config, foreign));
        }
        let Some((head, payload)) = bytes.split_at_checked(HEAD) else {
            return Err(self.damaged());
        };
        let (_, words) = head.split_at(MAGIC.len());
        let (own, checksum) = words.split_at(8);
        if checksum != hash(payload.iter().copied()).to_le_bytes() {
            return Err(self.damaged());
        }
        if own != fingerprint.to_le_bytes() {
            let other = "is the checkpoint of another picture, other options or another version: give those \
                         again, or name another file";
            return Err(self.refusal(ErrorKind::Config, other));
        }
        Ok(payload)
    }

    fn damaged(&self) -> Error {
        self.refusal(
            ErrorKind::Io,
            "the checkpoint is damaged: remove it to start anew",
        )
    }

    fn refusal(&self, kind: ErrorKind, what: &str) -> Error {
        Error::new(kind, format!("{}: {what}", self.path.display()))
    }

    /// True if it is time to write.
    pub(in crate::fit) fn is_due(&self) -> bool {
        Instant::now() >= self.due
    }

    /// Writes `state`. A failure is recorded as [`trouble`](Self::trouble), and does not end the fit.
    pub(in crate::fit) fn keep(&mut self, fingerprint: u64, state: &impl Serialize) {
        let start = Instant::now();
        self.trouble = self.write(fingerprint, state).err();
        let end = Instant::now();
        // A slow disk lengthens the interval, so that writes never take more than their share of the time.
        self.due = end + self.every.max((end - start) * MAX_SHARE);
    }

    /// Writes `state`, or returns why it cannot be written.
    pub(in crate::fit) fn write(&self, fingerprint: u64, state: &impl Serialize) -> Result<()> {
        let unwritable = |cause: &dyn std::fmt::Display| {
            let message = format!("cannot be written ({cause}): name another file");
            self.refusal(ErrorKind::Io, &message)
        };
        let payload = coding::encoded(state).map_err(|e| unwritable(&e).caused_by(e))?;
        let checksum = hash(payload.iter().copied());
        let head = [
            MAGIC,
            &fingerprint.to_le_bytes()[..],
            &checksum.to_le_bytes(),
        ]
        .concat();
        replace(&self.path, &[&head, &payload]).map_err(|e| unwritable(&e).caused_by(e))
    }
}

/// States as bytes, in CBOR.
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
mod coding {
    use std::io;

    use serde::{Serialize, de::DeserializeOwned};

    pub(super) fn encoded(state: &impl Serialize) -> io::Result<Vec<u8>> {
        cbor4ii::serde::to_vec(Vec::new(), state).map_err(io::Error::other)
    }

    pub(super) fn decoded<T: DeserializeOwned>(bytes: &[u8]) -> io::Result<T> {
        cbor4ii::serde::from_slice(bytes).map_err(io::Error::other)
    }
}

/// A web page has no files, and need not download what would write them.
#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod coding {
    use std::io;

    pub(super) fn encoded<T>(_: &T) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub(super) fn decoded<T>(_: &[u8]) -> io::Result<T> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

/// Replaces the file at `path` by one that consists of `parts`.
fn replace(path: &Path, parts: &[&[u8]]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let beside = path.with_file_name(name);
    let mut file = File::create(&beside)?;
    parts.iter().try_for_each(|part| file.write_all(part))?;
    // Without this, a loss of power could leave the renamed file empty.
    file.sync_all()?;
    fs::rename(beside, path)
}

/// A hash of everything that the bytes of a fit depend on.
pub(in crate::fit) fn fingerprint(
    target: &Image,
    config: &Config,
    base: Option<&Base>,
    focus: Option<&Focus>,
) -> u64 {
    let size = [target.width() as u64, target.height() as u64];
    let version = env!("CARGO_PKG_VERSION");
    let words = format!("{version} {config:?} {base:?}");
    let planes = target.planes().iter().flatten();
    let values = planes.chain(target.alpha().unwrap_or_default());
    let values = values.chain(focus.map_or(&[][..], Focus::values));
    hash(
        size.into_iter()
            .flat_map(u64::to_le_bytes)
            .chain(words.bytes())
            .chain(values.flat_map(|value| value.to_bits().to_le_bytes())),
    )
}

/// 64-bit FNV-1a: it detects accidents, not forgeries.
fn hash(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place() -> (tempfile::TempDir, Checkpoint) {
        let folder = tempfile::tempdir().unwrap();
        let checkpoint = Checkpoint::new(folder.path().join("a.state"));
        (folder, checkpoint)
    }

    #[test]
    fn numbers_come_back_to_the_bit() {
        let (_folder, checkpoint) = place();
        let state = vec![0.1_f32, -0.0, f32::MIN_POSITIVE / 3.0, f32::INFINITY];
        checkpoint.write(7, &state).unwrap();
        let back: Vec<f32> = checkpoint.load(7).unwrap().unwrap();
        let bits = |v: &[f32]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&state));
    }

    #[test]
    fn without_a_file_there_is_no_state() {
        let (_folder, checkpoint) = place();
        assert_eq!(checkpoint.load::<u32>(7).unwrap(), None);
        checkpoint.remove().unwrap();
    }

    #[test]
    fn the_state_of_another_fit_is_refused() {
        let (_folder, checkpoint) = place();
        checkpoint.write(7, &1_u32).unwrap();
        let error = checkpoint.load::<u32>(8).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Config);
        assert!(error.to_string().contains("another picture"), "{error}");
    }

    #[test]
    fn every_damage_is_found() {
        let (_folder, checkpoint) = place();
        checkpoint.write(7, &[1.5_f64; 4]).unwrap();
        let intact = fs::read(&checkpoint.path).unwrap();
        for at in 0..intact.len() {
            let mut flipped = intact.clone();
            flipped[at] ^= 0x40;
            for bytes in [&flipped[..], &intact[..at]] {
                fs::write(&checkpoint.path, bytes).unwrap();
                assert!(checkpoint.load::<[f64; 4]>(7).is_err(), "byte {at}");
            }
        }
    }

    #[test]
    fn a_failure_to_keep_is_noted() {
        let mut checkpoint = Checkpoint::new("/nowhere/at/all");
        checkpoint.keep(7, &1_u32);
        let trouble = checkpoint.trouble().unwrap().to_string();
        assert!(
            trouble.contains("/nowhere/at/all: cannot be written"),
            "{trouble}"
        );
    }

    #[test]
    fn options_and_pictures_have_fingerprints_of_their_own() {
        let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let of = |color, seed| {
            let config = Config {
                seed,
                ..Config::default()
            };
            let picture = Image::filled(3, 2, color).unwrap();
            fingerprint(&picture, &config, None, None)
        };
        assert_eq!(of(red, 1), of(red, 1));
        assert_ne!(of(red, 1), of(red, 2));
        assert_ne!(of(red, 1), of(blue, 1));
    }
}
