//! Where an experiment's files go.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use crate::error::{Error, ErrorKind, Result};
use crate::image::{Animation, Image};

/// A folder for results, and somebody to tell of them.
pub struct Output<'a> {
    dir: PathBuf,
    say: &'a mut dyn FnMut(&str),
}

impl<'a> Output<'a> {
    /// Results go to the folder `dir`, which is made if need be; `say` is told of each file
    /// and of what is under way.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when the folder cannot be made.
    pub fn new(dir: impl Into<PathBuf>, say: &'a mut dyn FnMut(&str)) -> Result<Self> {
        let dir = dir.into();
        fs::create_dir_all(&dir).map_err(|e| unwritten(&dir, e))?;
        Ok(Self { dir, say })
    }

    /// Tells what is under way.
    pub fn say(&mut self, message: &str) {
        (self.say)(message);
    }

    /// Where the file `name` goes.
    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }

    /// Writes a text file.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when it cannot be written.
    pub fn text(&mut self, name: &str, text: &str) -> Result<()> {
        self.bytes(name, text.as_bytes())
    }

    /// Writes a picture as PNG.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when it cannot be written, [`ErrorKind::Picture`] when it is too large.
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
        let mut animation = self.start_animation(name, frame_ms)?;
        for frame in frames {
            animation.push(&frame?)?;
        }
        self.written(name);
        Ok(())
    }

    /// Starts an animated GIF for frames that come one by one.
    ///
    /// # Errors
    /// [`ErrorKind::Io`] when it cannot be written.
    pub fn start_animation(&self, name: &str, frame_ms: u32) -> Result<Animation<BufWriter<File>>> {
        let path = self.path(name);
        let file = File::create(&path).map_err(|e| unwritten(&path, e))?;
        Animation::new(BufWriter::new(file), frame_ms)
    }

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path(name);
        fs::write(&path, bytes).map_err(|e| unwritten(&path, e))?;
        self.written(name);
        Ok(())
    }

    fn written(&mut self, name: &str) {
        let message = format!("wrote {}", self.path(name).display());
        self.say(&message);
    }
}

fn unwritten(path: &Path, cause: std::io::Error) -> Error {
    let message = format!(
        "cannot write {}: {cause}; choose another folder with -o",
        path.display()
    );
    Error::new(ErrorKind::Io, message).caused_by(cause)
}
