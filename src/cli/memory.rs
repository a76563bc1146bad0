//! How much memory we may take: three quarters of the least of machine, enclosing control groups, Slurm allocation; and that
//! it is no more.

use std::fs;
use std::io::{Write, stderr};
use std::path::{Path, PathBuf};
use std::sync::Once;
use std::thread;
use std::time::Duration;

use super::error::Failure;
use crate::files::exit;
use crate::math::Memory;
use crate::model::Model;

/// Where nothing else is known.
const FALLBACK: u64 = 4 << 30;

/// What a call may take: `max_memory` bytes, or what is known to be there. The process is held to it.
pub fn held(max_memory: Option<u64>) -> Memory {
    let limit = max_memory.unwrap_or_else(default_limit);
    hold(limit);
    Memory::new(limit)
}

/// What is told of a call's memory: bytes that it was thought to take, with the program's own, and that it took at most.
pub fn told(memory: &Memory) -> serde_json::Value {
    let peak = fs::read_to_string("/proc/self/status").ok().and_then(|status| kilobytes(&status, "VmHWM:"));
    serde_json::json!({ "estimated": OWN + memory.most(), "peak": peak })
}

/// Asks for what writing `model` takes beside it.
///
/// # Errors
/// Where that is more than allowed.
pub fn ask_beside(model: &Model, needed: u64, memory: &Memory) -> Result<(), Failure> {
    let asked = memory.beside(model.bytes() as u64).ask(needed);
    asked.map_err(|error| Failure::Usage(format!("writing the scene needs {error}: raise --max-memory")))
}

/// The default of `--max-memory`, in bytes.
fn default_limit() -> u64 {
    limit([machine(), control_group(Path::new("/sys/fs/cgroup")), slurm(&|name| std::env::var(name).ok())])
}

/// What the program takes for itself, whatever it makes.
const OWN: u64 = 18 << 20;
/// How often we look how much memory we take.
const POLL: Duration = Duration::from_millis(20);

/// From now on the process ends, with one clear error, when it takes more than `limit` bytes besides [`OWN`]: where estimates,
/// which refuse what is too large before it is made, are wrong.
fn hold(limit: u64) {
    static HELD: Once = Once::new();
    HELD.call_once(|| {
        let watch = move || {
            while let Some(taken) = resident() {
                if taken > limit.saturating_add(OWN) {
                    let _ = writeln!(
                        stderr(),
                        "error: it takes more than the {} MB of memory allowed: make less of it, or raise --max-memory",
                        limit / 1_000_000
                    );
                    exit(2);
                }
                thread::sleep(POLL);
            }
        };
        // Without a thread the estimates alone hold.
        let _ = thread::Builder::new().spawn(watch);
    });
}

/// Bytes of memory that we take; `None` where the system does not tell.
fn resident() -> Option<u64> {
    kilobytes(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Three quarters of the least of what is known.
fn limit(known: [Option<u64>; 3]) -> u64 {
    known.into_iter().flatten().min().unwrap_or(FALLBACK) / 4 * 3
}

fn machine() -> Option<u64> {
    kilobytes(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")
}

fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// The least limit of our control group and all around it, in version 2 or 1.
fn control_group(root: &Path) -> Option<u64> {
    let own = fs::read_to_string("/proc/self/cgroup").ok()?;
    let limits = own.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?);
        let (root, file): (PathBuf, _) = match controllers {
            "" => (root.to_owned(), "memory.max"),
            c if c.split(',').any(|c| c == "memory") => (root.join("memory"), "memory.limit_in_bytes"),
            _ => return None,
        };
        let inner = root.join(path.trim_start_matches('/'));
        // `max` is no number, and so no limit.
        inner
            .ancestors()
            .take_while(|folder| folder.starts_with(&root))
            .filter_map(|folder| fs::read_to_string(folder.join(file)).ok()?.trim().parse().ok())
            .min()
    });
    limits.min()
}

/// Megabytes of a Slurm allocation on this node.
fn slurm(variable: &dyn Fn(&str) -> Option<String>) -> Option<u64> {
    let number = |name: &str| variable(name)?.parse::<u64>().ok().filter(|&n| n > 0);
    let megabytes = number("SLURM_MEM_PER_NODE")
        .or_else(|| number("SLURM_MEM_PER_CPU")?.checked_mul(number("SLURM_CPUS_ON_NODE")?))?;
    megabytes.checked_mul(1 << 20)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_systems_say() {
        assert_eq!(kilobytes("MemTotal:       24689660 kB\nMemFree: 1 kB", "MemTotal:"), Some(24_689_660 * 1024));
        let node = |name: &str| (name == "SLURM_MEM_PER_NODE").then(|| "2048".to_owned());
        assert_eq!(slurm(&node), Some(2 << 30));
        let cpu = |name: &str| match name {
            "SLURM_MEM_PER_CPU" => Some("1024".to_owned()),
            "SLURM_CPUS_ON_NODE" => Some("4".to_owned()),
            _ => None,
        };
        assert_eq!(slurm(&cpu), Some(4 << 30));
        assert_eq!(slurm(&|_| None), None);
        assert_eq!(limit([Some(8 << 30), None, Some(4 << 30)]), 3 << 30);
        assert_eq!(limit([None; 3]), FALLBACK / 4 * 3);
    }
}
