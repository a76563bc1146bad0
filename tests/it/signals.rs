//! A signal ends every verb: soon, with its own exit code, the old file in place and nothing left; also KILL.

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::sample::tests_all;
use crate::support::{lichtenberg, succeed_in, tell};

/// A process that has not ended by then hangs.
const HANGS: Duration = Duration::from_secs(10);
/// Numbers of the signals.
const SIGNALS: [(&str, i32); 5] = [("INT", 2), ("TERM", 15), ("HUP", 1), ("QUIT", 3), ("KILL", 9)];
/// So soon after the end of a process its children have ended too.
const SOON: Duration = Duration::from_secs(2);

/// Sends `signal` to what runs with `args` after `wait`; how it ended. Its temporary files are in `scratch`.
fn interrupt(folder: &Path, scratch: &Path, args: &[&str], signal: &str, wait: Duration) -> ExitStatus {
    let mut child = lichtenberg()
        .current_dir(folder)
        .env("TMPDIR", scratch)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    sleep(wait);
    // It may have ended.
    Command::new("kill").args(["-s", signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    let sent = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if sent.elapsed() > HANGS {
            child.kill().unwrap();
            panic!("{args:?} does not heed {signal}");
        }
        sleep(Duration::from_millis(5));
    }
}

/// How many processes work in a folder below `place`?
fn workers(place: &Path) -> usize {
    let processes = fs::read_dir("/proc").unwrap().flatten();
    processes
        .filter(|process| fs::read_link(process.path().join("cwd")).is_ok_and(|cwd| cwd.starts_with(place)))
        .count()
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
}

#[test]
fn signals_end_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let scratch = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // Some verbs read pictures; large ones take a while.
    succeed_in(folder.path(), &["render", "night-bolt", "--size", "2400x1600", "-o", "sky.png"]);
    fs::copy(at("sky.png"), at("other.png")).unwrap();
    let verbs: [&[&str]; 7] = [
        &["render", "elm", "-o", "out.png"],
        &["render", "elm", "--with", "povray", "-o", "out.png"],
        &["render", "night-bolt", "--size", "2400x1600", "-o", "out.png"],
        &["export", "elm", "--to", "pov", "-o", ".", "--name", "out"],
        &["strike", "sky.png", "--to", "0.5,0.5", "-o", "out.png"],
        &["compare", "sky.png", "other.png", "--html", "out.html"],
        &["info", "elm"],
    ];
    let outputs = ["out.png", "out.html", "out.inc"];
    for name in outputs {
        fs::write(at(name), "old").unwrap();
    }
    let count = names(folder.path()).len();
    let rounds = if tests_all() { 30 } else { 3 };
    let mut ended = [0; SIGNALS.len()];
    for (round, (i, args)) in (0..rounds).flat_map(|round| verbs.iter().enumerate().map(move |verb| (round, verb))) {
        let which = (i + round) % SIGNALS.len();
        let (signal, number) = SIGNALS[which];
        let wait = Duration::from_millis((40 + (round * 7 + i) as u64 * 83) % 900);
        let status = interrupt(folder.path(), scratch.path(), args, signal, wait);
        let what = format!("{args:?} after {wait:?}, {signal}: {status}");
        // It may have been done before.
        let is_done = status.code() == Some(0);
        let is_killed = signal == "KILL" && status.signal() == Some(number);
        assert!(is_done || is_killed || status.code() == Some(128 + number), "{what}");
        ended[which] += usize::from(!is_done);
        let whole = ["out.pov", "out.ini", "out-stage.inc", "out-sky.exr"].map(|name| usize::from(at(name).exists()));
        let left = names(folder.path());
        assert_eq!(left.len(), count + whole.iter().sum::<usize>(), "{what}: {left:?}");
        if !is_done {
            for name in outputs {
                let bytes = fs::read(at(name)).unwrap();
                assert!(bytes == b"old" || is_whole(name, &bytes), "{what}: half of {name}");
            }
        }
        let since = Instant::now();
        while workers(scratch.path()) > 0 {
            assert!(since.elapsed() < SOON, "{what}: a child lives on");
            sleep(Duration::from_millis(5));
        }
    }
    let total: usize = ended.iter().sum();
    tell(&format!("of {} runs {total} were interrupted: {ended:?} by {SIGNALS:?}", rounds * verbs.len()));
    assert!(total * 3 > rounds * verbs.len(), "only {total} runs were interrupted");
    // What KILL left of a renderer's files goes when there is a next.
    let render = ["render", "cactus", "--size", "32x32", "--with", "povray", "-o", "last.png"];
    assert!(
        lichtenberg().current_dir(folder.path()).env("TMPDIR", scratch.path()).args(render).status().unwrap().success()
    );
    assert!(names(scratch.path()).is_empty(), "{:?}", names(scratch.path()));
}

/// Is the file complete?
fn is_whole(name: &str, bytes: &[u8]) -> bool {
    match name.rsplit('.').next() {
        Some("png") => bytes.ends_with(b"IEND\xae\x42\x60\x82"),
        Some("html") => bytes.trim_ascii_end().ends_with(b"</html>"),
        _ => bytes.ends_with(b"\n"),
    }
}
