//! A signal ends every verb: soon, with its own exit code, the old file in place and nothing left.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{lichtenberg, succeed_in};

/// A process that has not ended by then hangs.
const HANGS: Duration = Duration::from_secs(10);
/// Numbers of the signals.
const SIGNALS: [(&str, i32); 4] = [("INT", 2), ("TERM", 15), ("HUP", 1), ("QUIT", 3)];

/// Sends `signal` to what runs with `args` after `wait`; its exit code.
fn interrupt(folder: &Path, args: &[&str], signal: &str, wait: Duration) -> Option<i32> {
    let mut child =
        lichtenberg().current_dir(folder).args(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    sleep(wait);
    // It may have ended.
    Command::new("kill").args(["-s", signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    let sent = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status.code();
        }
        if sent.elapsed() > HANGS {
            child.kill().unwrap();
            panic!("{args:?} does not heed {signal}");
        }
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn signals_end_every_verb() {
    let folder = tempfile::tempdir().unwrap();
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
    let count = fs::read_dir(folder.path()).unwrap().count();
    let rounds = if std::env::var_os("LICHTENBERG_TEST_ALL").is_some() { 28 } else { 3 };
    let mut ended = 0;
    for round in 0..rounds {
        for (i, args) in verbs.iter().enumerate() {
            let (signal, number) = SIGNALS[(i + round) % SIGNALS.len()];
            let wait = Duration::from_millis((40 + (round * 7 + i) as u64 * 83) % 900);
            let code = interrupt(folder.path(), args, signal, wait);
            // It may have been done before.
            assert!([Some(0), Some(128 + number)].contains(&code), "{args:?} after {wait:?}, {signal}: {code:?}");
            ended += usize::from(code != Some(0));
            let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
            let whole = ["out.pov", "out.ini"].map(|name| usize::from(at(name).exists()));
            assert_eq!(left.len(), count + whole.iter().sum::<usize>(), "{args:?}, {signal}: {left:?}");
            if code != Some(0) {
                for name in outputs {
                    let bytes = fs::read(at(name)).unwrap();
                    assert!(bytes == b"old" || is_whole(name, &bytes), "{args:?}, {signal}: half of {name}");
                }
            }
        }
    }
    assert!(ended * 3 > rounds * verbs.len(), "only {ended} runs were interrupted");
}

/// Is the file complete?
fn is_whole(name: &str, bytes: &[u8]) -> bool {
    match name.rsplit('.').next() {
        Some("png") => bytes.ends_with(b"IEND\xae\x42\x60\x82"),
        Some("html") => bytes.trim_ascii_end().ends_with(b"</html>"),
        _ => bytes.ends_with(b"\n"),
    }
}
