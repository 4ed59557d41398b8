//! The folder that an experiment writes to, and a callback for its progress.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use strokefit::image::{AnimationFormat, Image, animated};
use strokefit::{Error, ErrorKind, Result};

/// Progress of an experiment.
#[derive(Debug, Clone, Copy)]
pub enum Notice<'a> {
    /// Something is under way.
    Doing {
        /// Which part of the whole is done, 0..1.
        done: f64,
        /// Name of the part that comes now.
        what: &'a str,
    },
    /// A file is complete.
    Wrote(&'a Path),
}

/// A folder for results, and a callback that is told of each file.
pub struct ResultFolder<'a> {
    dir: PathBuf,
    tell: &'a mut dyn FnMut(Notice<'_>),
}

impl<'a> ResultFolder<'a> {
    /// Results go to the folder `dir`, which is made if need be; `tell` is told of each file and of
    /// what is under way.
    ///
    /// # Errors
    /// [`ErrorKind::Io`](strokefit::ErrorKind::Io) when the folder cannot be made.
    pub fn new(dir: impl Into<PathBuf>, tell: &'a mut dyn FnMut(Notice<'_>)) -> Result<Self> {
        let dir = dir.into();
        fs::create_dir_all(&dir).map_err(|e| unwritten(&dir, e))?;
        Ok(Self { dir, tell })
    }

    /// Tells what is under way, and which part (0..1) of the whole is done.
    pub fn doing(&mut self, done: f64, what: &str) {
        (self.tell)(Notice::Doing { done, what });
    }

    /// Writes a text file.
    ///
    /// # Errors
    /// [`ErrorKind::Io`](strokefit::ErrorKind::Io) when it cannot be written.
    pub fn text(&mut self, name: &str, text: &str) -> Result<()> {
        self.bytes(name, text.as_bytes())
    }

    /// Writes a picture as PNG.
    ///
    /// # Errors
    /// [`ErrorKind::Io`](strokefit::ErrorKind::Io) when it cannot be written,
    /// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when it is too large.
    pub fn picture(&mut self, name: &str, image: &Image) -> Result<()> {
        self.bytes(name, &image.encode_png()?)
    }

    /// Writes an animated GIF of frames of `frame_ms` each.
    ///
    /// # Errors
    /// As [`picture`](Self::picture), and the first error among `frames`.
    pub fn animation(
        &mut self,
        name: &str,
        frame_ms: u32,
        frames: impl IntoIterator<Item = Result<Image>>,
    ) -> Result<()> {
        let frames = frames.into_iter().map(|frame| Ok((frame?, frame_ms)));
        let frames: Vec<_> = frames.collect();
        self.bytes(name, &animated(AnimationFormat::Gif, frames.into_iter())?)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// [`ErrorKind::Io`](strokefit::ErrorKind::Io) when it cannot be written.
    pub fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.dir.join(name);
        fs::write(&path, bytes).map_err(|e| unwritten(&path, e))?;
        (self.tell)(Notice::Wrote(&path));
        Ok(())
    }
}

/// The error for a file `path` of results that could not be written.
pub fn unwritten(path: &Path, cause: io::Error) -> Error {
    let message = format!(
        "cannot write {}: {cause}; choose another folder with -o",
        path.display()
    );
    Error::new(ErrorKind::Io, message).caused_by(cause)
}
