//! How much memory we may take: three quarters of the least of machine, enclosing control groups, Slurm allocation.

use std::fs;
use std::path::{Path, PathBuf};

/// Where nothing else is known.
const FALLBACK: u64 = 4 << 30;

/// The default of `--max-memory`, in bytes.
pub fn default_limit() -> u64 {
    limit([machine(), control_group(Path::new("/sys/fs/cgroup")), slurm(&|name| std::env::var(name).ok())])
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
