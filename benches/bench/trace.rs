//! Ray queries, side by side with Embree where a C++ compiler and its library are there.
//!
//! `cargo bench -- trace` prints, for branching trees of 10k, 100k and 1M segments: build times, and rays a second
//! on one core of primary, shadow and ambient-occlusion rays, ours and Embree's on the same files.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::trees::tree;
use lichtenberg::bvh::{Cones, Ray, RoundCone};
use lichtenberg::math::{DVec3, Stream};
use rand::RngExt;

const WIDTH: usize = 1280;
const HEIGHT: usize = 720;
/// Runs of each measurement; the median counts.
const RUNS: usize = 5;

fn camera() -> Vec<Ray> {
    let eye = DVec3::new(0.0, -20.0, 6.0);
    let mut rays = Vec::with_capacity(WIDTH * HEIGHT);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let u = (x as f64 + 0.5) / WIDTH as f64 - 0.5;
            let v = 0.5 - (y as f64 + 0.5) / HEIGHT as f64;
            let way = DVec3::new(u, 0.9, v * HEIGHT as f64 / WIDTH as f64).normalize();
            rays.push(Ray::new(eye, way));
        }
    }
    rays
}

/// Shadow rays towards a sun and ambient-occlusion rays from what `rays` hit.
fn secondary(cones: &Cones, all: &[RoundCone], rays: &[Ray]) -> [Vec<Ray>; 2] {
    let sun = DVec3::new(0.4, -0.5, 0.7).normalize();
    let mut random = Stream::new(2, "bench");
    let [mut shadow, mut ambient] = [Vec::new(), Vec::new()];
    for ray in rays {
        let Some(hit) = cones.closest(ray) else { continue };
        let Some(entry) = all[hit.id as usize].enter(ray) else { continue };
        let (t, n) = (entry.t, entry.normal);
        let p = ray.at(t) + n * 2e-5 * 20.0;
        if n.dot(sun) > 0.0 {
            shadow.push(Ray::new(p, sun));
        }
        let z = random.random_range(-1.0..1.0_f64);
        let turn = random.random_range(0.0..std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        let way = n + DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z);
        ambient.push(Ray::new(p, way.normalize_or(n)));
    }
    [shadow, ambient]
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn time<T>(mut work: impl FnMut() -> T) -> f64 {
    median(
        (0..RUNS)
            .map(|_| {
                let begun = Instant::now();
                std::hint::black_box(work());
                begun.elapsed().as_secs_f64()
            })
            .collect(),
    )
}

/// A line of what the system knows of this process, in kilobytes; 0 where there is none.
fn memory(key: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

fn write_floats(path: &Path, numbers: impl Iterator<Item = f64>) {
    let mut out = std::io::BufWriter::new(fs::File::create(path).expect("a file"));
    for x in numbers {
        out.write_all(&(x as f32).to_le_bytes()).expect("written");
    }
}

/// Compiles the program beside this file against Embree, where that can be done.
fn embree(folder: &Path) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/embree.cpp");
    let program = folder.join("embree");
    let made = Command::new("c++").args(["-O3", "-o"]).arg(&program).arg(&source).arg("-lembree3").status();
    if made.is_ok_and(|status| status.success()) {
        return Some(program);
    }
    println!("without Embree: apt-get install g++ libembree-dev");
    None
}

pub fn run() {
    let folder = tempfile::tempdir().expect("a folder");
    let embree = embree(folder.path());
    for count in [10_000, 100_000, 1_000_000] {
        let all = tree(count);
        let before = memory("VmRSS:");
        let cones = Cones::new(count, |i| all[i]);
        println!(
            "{count:>8} ours    {} MB more at the peak of building",
            memory("VmHWM:").saturating_sub(before) / 1000
        );
        let rays = camera();
        let [shadow, ambient] = secondary(&cones, &all, &rays);
        let build = time(|| Cones::new(count, |i| all[i]));
        let hits = rays.iter().filter(|r| cones.closest(r).is_some()).count();
        let blocked = [&shadow, &ambient].map(|rays| rays.iter().filter(|r| cones.is_blocked(r)).count());
        let seconds = [
            time(|| rays.iter().filter(|r| cones.closest(r).is_some()).count()),
            time(|| shadow.iter().filter(|r| cones.is_blocked(r)).count()),
            time(|| ambient.iter().filter(|r| cones.is_blocked(r)).count()),
        ];
        let sets = [&rays, &shadow, &ambient];
        let rate = |i: usize| sets[i].len() as f64 / seconds[i] / 1e6;
        println!(
            "{count:>8} ours    build {:7.1} ms, {:.2} {:.2} {:.2} million rays/s, {hits} hits, {blocked:?} blocked, {} MB",
            build * 1e3,
            rate(0),
            rate(1),
            rate(2),
            cones.bytes() / 1_000_000
        );
        let Some(program) = &embree else { continue };
        let numbers = |p: DVec3, w: f64| [p.x, p.y, p.z, w];
        let path = |name: &str| folder.path().join(name);
        write_floats(&path("cones"), all.iter().flat_map(|c| [numbers(c.a, c.ra), numbers(c.b, c.rb)]).flatten());
        for (name, rays) in ["primary", "shadow", "ambient"].iter().zip(sets) {
            write_floats(
                &path(name),
                rays.iter().flat_map(|r| [r.origin.to_array(), r.direction.to_array()]).flatten(),
            );
        }
        let output = Command::new(program).current_dir(folder.path()).output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let theirs: Vec<f64> = said.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let [ms, a, b, c, hits, shadowed, occluded] = theirs[..] else { panic!("embree said {said}") };
        println!(
            "{count:>8} Embree  build {ms:7.1} ms, {a:.2} {b:.2} {c:.2} million rays/s, {hits} hits, [{shadowed}, {occluded}] blocked"
        );
        println!(
            "{count:>8} ratio   build {:.2}, rays {:.2} {:.2} {:.2}",
            build * 1e3 / ms,
            rate(0) / a,
            rate(1) / b,
            rate(2) / c
        );
    }
}
