//! Writes output files; `-` is standard output. A file appears complete under its name or not at all, and its folder is
//! made where it is missing.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use anyhow::{Result, anyhow};

const STDOUT: &str = "-";

/// Where data goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Output {
    /// Standard output.
    Stdout,
    /// A regular file, there already or to be made: written beside its name, then renamed.
    File(PathBuf),
    /// A device or pipe: written in place.
    Device(PathBuf),
}

/// The name of the file in messages.
pub(super) fn name(path: &Path) -> String {
    if path == Path::new(STDOUT) {
        "standard output".into()
    } else {
        path.display().to_string()
    }
}

impl Output {
    /// The output that `path` means, once it is certain that it can be written.
    pub(super) fn open(path: &Path) -> Result<Self> {
        if path == Path::new(STDOUT) {
            return Ok(Self::Stdout);
        }
        let output = Self::locate(path).and_then(|output| output.rehearse().map(|()| output));
        output.map_err(|e| unwritable(path, &e))
    }

    fn locate(path: &Path) -> io::Result<Self> {
        let last = path.as_os_str().as_encoded_bytes().last();
        let names_a_folder = last.is_some_and(|&byte| std::path::is_separator(byte.into()));
        let path = canonical(path);
        match fs::metadata(&path) {
            Err(_) if names_a_folder => Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => Ok(Self::Device(path)),
            Ok(found) if found.permissions().readonly() => {
                Err(io::ErrorKind::PermissionDenied.into())
            }
            _ => Ok(Self::File(path)),
        }
    }

    /// Fails as writing would, and leaves nothing behind.
    fn rehearse(&self) -> io::Result<()> {
        match self {
            Self::Stdout => Ok(()),
            // An unnamed file, where the system has those: nobody ever sees it.
            Self::File(path) => tempfile::tempfile_in(nearest_folder(path)?).map(drop),
            Self::Device(path) => OpenOptions::new().write(true).open(path).map(drop),
        }
    }

    /// A file that is written bit by bit, from its start.
    pub(super) fn stream(&self) -> io::Result<Box<dyn Write + Send>> {
        Ok(match self {
            Self::Stdout => Box::new(io::stdout()),
            Self::File(path) => {
                make_folder(path)?;
                Box::new(File::create(path)?)
            }
            Self::Device(path) => Box::new(File::create(path)?),
        })
    }

    /// Writes everything.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        match self {
            Self::Stdout => {
                let mut stdout = io::stdout().lock();
                let outcome = stdout.write_all(bytes).and_then(|()| stdout.flush());
                match outcome {
                    // A reader that went away has seen what it wanted.
                    Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
                        Err(anyhow!("standard output cannot be written: {e}"))
                    }
                    _ => Ok(()),
                }
            }
            Self::File(path) => replace(path, bytes).map_err(|e| unwritable(path, &e)),
            Self::Device(path) => {
                let device = OpenOptions::new().write(true).open(path);
                device
                    .and_then(|mut d| d.write_all(bytes))
                    .map_err(|e| unwritable(path, &e))
            }
        }
    }

    /// True if the output is this file.
    pub(super) fn is(&self, path: &Path) -> bool {
        match (self, fs::canonicalize(path)) {
            (Self::File(own), Ok(path)) => *own == path,
            _ => false,
        }
    }
}

/// One name for each file, so that two outputs can be compared. A link is followed, even where it leads to no file yet;
/// folders that are missing count as made.
fn canonical(path: &Path) -> PathBuf {
    if let Ok(path) = fs::canonicalize(path) {
        return path;
    }
    // An output that is there but has no path, such as a pipe, is written under the name that was given.
    let path = if path.exists() {
        path.to_owned()
    } else {
        followed(path)
    };
    located(&path).unwrap_or(path)
}

/// Most links that are followed one after the other, as on Linux.
const MAX_LINKS: usize = 40;

/// Where the last link leads that begins at `path`.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = folder(&path).join(target),
            Err(_) => break,
        }
    }
    path
}

/// `path` below the nearest folder that is there, which is given its one name.
fn located(path: &Path) -> Option<PathBuf> {
    let parent = folder(path);
    let place = fs::canonicalize(parent).ok().or_else(|| located(parent))?;
    match path.components().next_back()? {
        // Folders that are to be made are no links, so that the one above is the one before.
        Component::ParentDir => place.parent().map(Path::to_owned),
        Component::CurDir => Some(place),
        last => Some(place.join(last)),
    }
}

fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// The folder in which `path` names a file.
fn target_folder(path: &Path) -> io::Result<&Path> {
    path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    Ok(folder(path))
}

/// The nearest folder above the file `path` that is there.
fn nearest_folder(path: &Path) -> io::Result<&Path> {
    let mut folder = target_folder(path)?;
    while fs::symlink_metadata(folder).is_err_and(|e| e.kind() == io::ErrorKind::NotFound) {
        folder = folder.parent().ok_or(io::ErrorKind::NotFound)?;
    }
    Ok(folder)
}

/// Makes the folder of the file `path`, if it is missing.
fn make_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(target_folder(path)?)
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    make_folder(path)?;
    let mut file = temporary(path)?;
    file.write_all(bytes)?;
    if let Ok(existing) = fs::metadata(path) {
        file.as_file().set_permissions(existing.permissions())?;
    }
    // Without this, a loss of power could leave the name on an empty file.
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

/// A file without the final name in the final folder, gone when dropped.
fn temporary(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".strokefit-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The mode of any new file, less the umask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(target_folder(path)?)
}

fn unwritable(path: &Path, error: &io::Error) -> anyhow::Error {
    let path = path.display();
    match error.kind() {
        io::ErrorKind::IsADirectory => {
            anyhow!("{path}: cannot be written, it is a folder: name a file in it")
        }
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            anyhow!("{path}: cannot be written, permission denied: choose another place")
        }
        io::ErrorKind::NotADirectory => {
            anyhow!("{path}: cannot be written, its folder is a file: choose another place")
        }
        _ => anyhow!("{path}: cannot be written ({error}): choose another place"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        fs::write(&path, "old and long").unwrap();
        let output = Output::open(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old and long");
        output.write(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn opening_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        Output::open(&folder.path().join("a.svg")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_cannot_be_written_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        for (path, why) in [
            (file.join("none/a.svg"), "is a file"),
            (folder.path().to_owned(), "is a folder"),
            (folder.path().join("new/"), "is a folder"),
            (file.join("a.svg"), "is a file"),
        ] {
            let error = Output::open(&path).unwrap_err().to_string();
            assert!(
                error.contains(why) && error.contains(&path.display().to_string()),
                "{error}"
            );
        }
    }

    #[test]
    fn folders_are_made_when_something_is_written_into_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/c.svg");
        let output = Output::open(&path).unwrap();
        assert!(!folder.path().join("a").exists());
        output.write(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        let streamed = folder.path().join("d/e.jsonl");
        let output = Output::open(&streamed).unwrap();
        output.stream().unwrap().write_all(b"line").unwrap();
        assert_eq!(fs::read_to_string(&streamed).unwrap(), "line");
    }

    #[test]
    fn a_file_has_one_name_before_its_folder_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let open = |name: &str| Output::open(&folder.path().join(name)).unwrap();
        assert_eq!(open("new/a.svg"), open("new/./b/../a.svg"));
        assert_eq!(open("new/../a.svg"), open("a.svg"));
        assert_ne!(open("new/a.svg"), open("a.svg"));
    }

    #[test]
    #[cfg(unix)]
    fn a_link_is_written_through_even_if_it_leads_to_no_file_yet() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("old"), "old").unwrap();
        for (link, target) in [
            ("to-old", "old"),
            ("to-new", "new"),
            ("far", "to-far"),
            ("to-far", "deep/far-end"),
        ] {
            std::os::unix::fs::symlink(target, at(link)).unwrap();
        }
        for (link, file) in [
            ("to-old", "old"),
            ("to-new", "new"),
            ("far", "deep/far-end"),
        ] {
            assert_eq!(
                Output::open(&at(link)).unwrap(),
                Output::open(&at(file)).unwrap()
            );
            Output::open(&at(link)).unwrap().write(b"written").unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink());
            assert_eq!(fs::read_to_string(at(file)).unwrap(), "written");
        }
    }
}
