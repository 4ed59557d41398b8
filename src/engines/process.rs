//! Runs a program as a child process, isolated from the user's files, and ends it when it hangs.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::fault;
use crate::error::Result;

/// Names of the files that take what a program says.
const OUTPUT: &str = "stdout";
const MESSAGES: &str = "stderr";

/// Time between two looks at whether the program has ended.
const PATIENCE: Duration = Duration::from_millis(5);

/// End of a program.
pub(super) struct Exit {
    pub(super) status: ExitStatus,
    /// Its standard output.
    pub(super) output: String,
    /// Its standard error.
    pub(super) messages: String,
}

/// Makes `folder` the program's home and its place for settings, caches and temporary files, and hides displays
/// and message buses. With `keeps_home`, `HOME` itself stays.
pub(super) fn isolate(command: &mut Command, folder: &Path, keeps_home: bool) {
    if !keeps_home {
        command.env("HOME", folder);
    }
    for name in [
        "XDG_CONFIG_HOME",
        "XDG_CACHE_HOME",
        "XDG_DATA_HOME",
        "XDG_STATE_HOME",
        "XDG_RUNTIME_DIR",
        "INKSCAPE_PROFILE_DIR",
        "TMPDIR",
        "TMP",
        "TEMP",
    ] {
        command.env(name, folder);
    }
    command.env("DBUS_SESSION_BUS_ADDRESS", "disabled:");
    for name in ["DISPLAY", "WAYLAND_DISPLAY"] {
        command.env_remove(name);
    }
    command.current_dir(folder);
}

/// True if this process, and so its children, run as root.
pub(super) fn is_root() -> bool {
    #[cfg(unix)]
    return rustix::process::geteuid().is_root();
    #[cfg(not(unix))]
    return false;
}

/// Runs a program to its end; after `timeout`, ends it and all that it started. Its output goes to files in
/// `folder`, because a pipe could fill up or be held open by a process that stays.
pub(super) fn run(mut command: Command, folder: &Path, timeout: Duration) -> Result<Exit> {
    let unusable = |e: io::Error| fault(format!("cannot be run ({e}): check the program"));
    let file = |name| File::create(folder.join(name));
    command
        .stdin(Stdio::null())
        .stdout(file(OUTPUT).map_err(unusable)?)
        .stderr(file(MESSAGES).map_err(unusable)?);
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut group = ProcessGroup(command.spawn().map_err(unusable)?);
    let Some(status) = group.wait(timeout).map_err(unusable)? else {
        let seconds = timeout.as_secs_f64();
        return Err(fault(format!(
            "ended after {seconds} s without a result: allow more time with --timeout"
        )));
    };
    let text = |name| fs::read(folder.join(name)).map(|b| String::from_utf8_lossy(&b).into_owned());
    Ok(Exit {
        status,
        output: text(OUTPUT).map_err(unusable)?,
        messages: text(MESSAGES).map_err(unusable)?,
    })
}

/// A child and its descendants. All of them are ended when this value is dropped.
struct ProcessGroup(Child);

impl ProcessGroup {
    /// Status of the child once it has ended, or `None` after `timeout`.
    fn wait(&mut self, timeout: Duration) -> io::Result<Option<ExitStatus>> {
        let start = Instant::now();
        loop {
            if let Some(status) = self.0.try_wait()? {
                return Ok(Some(status));
            }
            if start.elapsed() >= timeout {
                return Ok(None);
            }
            thread::sleep(PATIENCE);
        }
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        // This fails when all have ended already, which is as well.
        #[cfg(unix)]
        let _ = rustix::process::kill_process_group(
            rustix::process::Pid::from_child(&self.0),
            rustix::process::Signal::KILL,
        );
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    fn shell(script: &str, timeout_s: u64) -> Result<Exit> {
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        isolate(&mut command, folder.path(), false);
        run(command, folder.path(), Duration::from_secs(timeout_s))
    }

    #[test]
    fn what_a_program_says_comes_back() {
        let outcome = shell("echo out; echo err >&2; exit 3", 60).unwrap();
        assert_eq!(
            (outcome.output.as_str(), outcome.messages.as_str()),
            ("out\n", "err\n")
        );
        assert_eq!(outcome.status.code(), Some(3));
    }

    #[test]
    fn a_program_that_hangs_is_ended_with_its_children() {
        let folder = tempfile::tempdir().unwrap();
        let mark = folder.path().join("alive");
        let script = format!(
            "(while :; do touch {0}; sleep 0.05; done) & wait",
            mark.display()
        );
        let error = shell(&script, 1).err().unwrap().to_string();
        assert!(error.contains("ended after 1 s"), "{error}");
        fs::remove_file(&mark).unwrap();
        thread::sleep(Duration::from_millis(500));
        assert!(!mark.exists(), "a child goes on");
    }

    #[test]
    fn home_settings_and_temporary_files_are_in_the_folder() {
        let script = "test \"$HOME\" = \"$PWD\" && test \"$XDG_CONFIG_HOME\" = \"$PWD\" \
                      && test \"$TMPDIR\" = \"$PWD\" && test -z \"$DISPLAY\"";
        assert!(shell(script, 60).unwrap().status.success());
    }
}
