//! The folder that results are written to, and the line on the terminal that shows how far they have come.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use strokefit::cli::bar::Bar;
use strokefit::image::Image;
use strokefit::{Error, ErrorKind, Result};

/// A folder for results.
pub struct ResultFolder {
    dir: PathBuf,
    bar: Bar,
    written: Vec<PathBuf>,
}

impl ResultFolder {
    /// Results go to the folder `dir`, which is made if need be. Progress is shown on a terminal, unless `quiet`.
    ///
    /// # Errors
    /// [`ErrorKind::Io`](strokefit::ErrorKind::Io) when the folder cannot be made.
    pub fn new(dir: impl Into<PathBuf>, quiet: bool) -> Result<Self> {
        let dir = dir.into();
        fs::create_dir_all(&dir).map_err(|e| unwritten(&dir, e))?;
        Ok(Self {
            dir,
            bar: Bar::new(quiet, ""),
            written: Vec::new(),
        })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.dir
    }

    /// Shows what is under way, and which part (0..1) of the whole is done.
    pub fn doing(&mut self, done: f64, what: &str) {
        self.bar.show(done, || what.to_owned());
    }

    /// Ends the line of progress; the files that were written.
    pub fn finish(mut self) -> Vec<PathBuf> {
        self.bar.clear();
        self.written
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

    fn bytes(&mut self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.dir.join(name);
        fs::write(&path, bytes).map_err(|e| unwritten(&path, e))?;
        self.written.push(path);
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

/// The error for a file `path` that could not be read.
pub fn unread(path: &Path, cause: io::Error) -> Error {
    let message = format!(
        "{}: cannot be read ({cause}): check the name and its permissions",
        path.display()
    );
    Error::new(ErrorKind::Io, message).caused_by(cause)
}
