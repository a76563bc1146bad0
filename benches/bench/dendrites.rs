//! Dendrites, surfaces and moss: Tables 1 and 2 of Xu and Mould 2007 beside the paper's times, Fig. 11's aggregate beside its
//! imitation, surfaces beside scikit-image's (where python3 has it), and a million strands. Times are of growth, medians; one
//! thread unless told. `--quick` leaves out the textbook's aggregate, which takes minutes.

use std::process::Command;
use std::time::Instant;

use crate::Failure;
use crate::clock::median;
use lichtenberg::export::{Origin, Pov, Rib, RibOptions, RibPart, Templates};
use lichtenberg::files::{Folder, embedded_scenes};
use lichtenberg::geom::Surface;
use lichtenberg::grow::Grown;
use lichtenberg::math::{Memory, Progress, mix};
use lichtenberg::scene::{Loaded, Override, Source, grow, load, model};
use lichtenberg::skeleton::dimension;
use lichtenberg::trace::{Look, RenderSettings, World, render};

/// Each is run this often, and the median told.
const RUNS: usize = 9;

fn embedded(name: &str, overrides: &[Override]) -> Result<Loaded, Failure> {
    let (name, text, folder) = embedded_scenes().into_iter().find(|(n, ..)| n == name).ok_or("no such scene")?;
    Ok(load(&Source { name, text: text.to_owned(), folder }, overrides)?)
}

fn grown(scene: &Loaded) -> Vec<Grown> {
    grow(scene, &[], &Memory::default(), &Progress::default()).expect("it grows")
}

fn one_thread<T: Send>(run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread").install(run)
}

fn tables() -> Result<(), Failure> {
    println!("Tables 1 and 2 of Xu and Mould 2007, on one core and on {}", rayon::current_num_threads());
    println!("{:<34} {:>9} {:>10} {:>9} {:>9}", "model", "endpoints", "the paper", "one", "all");
    for (what, name, paper) in [
        ("simple dendrite, 600 x 600", "papers/2007-table1-dendrite", 0.94),
        ("fractal, 512 x 512", "papers/2007-table1-fractal", 7.55),
        ("coral, 50^3", "papers/2007-table1-coral", 1.06),
        ("coral, refined", "papers/2007-fig12", 3.06),
        ("rock, 128^3, with its surface", "papers/2007-fig10", 11.2),
        ("rock and lichen, 128^3, surfaces", "papers/2007-fig16", 16.9),
    ] {
        let scene = embedded(name, &[])?;
        let mut endpoints = 0;
        let mut run = || {
            let grown = grown(&scene);
            endpoints = grown.iter().map(|g| g.skeleton.paths.len()).sum();
            if name.ends_with("fig16") {
                model(&scene, &grown, scene.recipe.size, &Memory::default(), &Progress::default()).expect("a model");
            }
        };
        let one = one_thread(|| median(&mut run, RUNS));
        let all = median(&mut run, RUNS);
        println!("{what:<34} {endpoints:>9} {paper:>8.2} s {:>6.1} ms {:>6.1} ms", one * 1e3, all * 1e3);
    }
    Ok(())
}

fn aggregate(quick: bool) -> Result<(), Failure> {
    println!("\nFig. 11: 25,000 particles at 500 x 500, and the imitation in 4 iterations; one core");
    let set = |path: &str, value: &str| Override { path: path.to_owned(), value: value.to_owned() };
    let fast = embedded("papers/2007-fig11", &[set("grow.imitation.by.fractal.iterations", "1")])?;
    let step = |grown: &[Grown], name: &str| grown.iter().position(|g| g.name == name).expect("a step");
    let textbook = embedded(
        "papers/2007-fig11",
        &[set("grow.aggregate.by.dla.walk", "textbook"), set("grow.imitation.by.fractal.iterations", "1")],
    )?;
    let imitation = embedded("papers/2007-fig11", &[set("grow.aggregate.by.dla.particles", "1")])?;
    let mut told = Vec::new();
    for (what, scene, name, runs) in [
        ("imitation", &imitation, "imitation", RUNS),
        ("fast aggregation", &fast, "aggregate", 3),
        ("textbook aggregation", &textbook, "aggregate", 1),
    ] {
        if quick && what.starts_with("textbook") {
            continue;
        }
        let mut d = 0.0;
        let seconds = one_thread(|| {
            median(
                || {
                    let all = grown(scene);
                    d = dimension(&[&all[step(&all, name)].skeleton]);
                },
                runs,
            )
        });
        told.push(seconds);
        println!("{what:<22} {seconds:>8.3} s  {:>7.0} times the imitation's  dimension {d:.3}", seconds / told[0]);
    }
    Ok(())
}

/// Extraction alone: a blobby field of `n`^3 samples.
fn surfaces() {
    println!("\nSurfaces from a field of samples, one thread");
    let n = 192_u32;
    let field: Vec<f32> = (0..n * n * n)
        .map(|i| {
            let at = [i % n, i / n % n, i / (n * n)].map(|c| f64::from(c) / f64::from(n) * 18.0);
            let wave: f64 = (0..3).map(|i| libm::sin(at[i]) * libm::cos(at[(i + 1) % 3])).sum();
            (wave + (mix(u64::from(i)) % 1000) as f64 * 1e-4) as f32
        })
        .collect();
    let cell = |[x, y, z]: [u32; 3]| (x + n * (y + n * z)) as usize;
    let mut triangles = 0;
    let seconds = median(
        || {
            let surface = Surface::extract(
                [n; 3],
                |at| field[cell(at)] < 0.0,
                |at, axis, up| {
                    let mut other = at;
                    other[axis] = other[axis].wrapping_add_signed(if up { 1 } else { -1 });
                    if other[axis] >= n {
                        return 0.5;
                    }
                    let (a, b) = (f64::from(field[cell(at)]), f64::from(field[cell(other)]));
                    a / (a - b)
                },
            );
            triangles = surface.triangles.len();
        },
        5,
    );
    let voxels = f64::from(n * n * n);
    println!("ours         {:>6.1} million voxels a second, {triangles} triangles", voxels / seconds * 1e-6);
    let script = "
import sys, time, numpy as np
from skimage.measure import marching_cubes
n = int(sys.argv[1])
field = np.fromfile(sys.argv[2], dtype=np.float32).reshape(n, n, n)
times = []
for _ in range(5):
    begun = time.perf_counter()
    points, faces, *_ = marching_cubes(field, 0.0)
    times.append(time.perf_counter() - begun)
print(f'scikit-image {n ** 3 / sorted(times)[2] * 1e-6:>6.1f} million voxels a second, {len(faces)} triangles')
";
    let path = std::env::temp_dir().join("lichtenberg-field.bin");
    let bytes: Vec<u8> = field.iter().flat_map(|x| x.to_le_bytes()).collect();
    let written = std::fs::write(&path, bytes).is_ok();
    let output = Command::new("python3").args(["-c", script, &n.to_string()]).arg(&path).output();
    match output.ok().filter(|output| written && output.status.success()) {
        Some(output) => print!("{}", String::from_utf8_lossy(&output.stdout)),
        None => println!("scikit-image is not there: pip install -r benches/requirements.txt"),
    }
    let _ = std::fs::remove_file(path);
}

fn moss() -> Result<(), Failure> {
    println!("\nA million strands of one piece, all threads");
    let name = "benches/scenes/moss-million.toml".to_owned();
    let text = std::fs::read_to_string(&name)?;
    let begun = Instant::now();
    let scene = load(&Source { name, text, folder: Folder::Disk("benches/scenes".into()) }, &[])?;
    let all = grown(&scene);
    let planned = begun.elapsed().as_secs_f64();
    let strands: usize = all.iter().map(|g| g.skeleton.paths.len()).sum();
    let model = model(&scene, &all, scene.recipe.size, &Memory::default(), &Progress::default())?;
    drop(all);
    let dressed = begun.elapsed().as_secs_f64();
    let templates = Templates::default();
    let origin = Origin::default();
    let mut bytes = [0_u64; 2];
    Pov::new(&model, &templates, "moss", scene.recipe.size, &origin).write_inc(Count(&mut bytes[0]))?;
    Rib::new(&model, &templates, "moss", scene.recipe.size, &origin, RibOptions::default())
        .write_part(RibPart::Archive, Count(&mut bytes[1]))?;
    let written = begun.elapsed().as_secs_f64();
    let view = RenderSettings::new(scene.recipe.size, Look::Studio, 4);
    render(&World::new(&model), &view, &Progress::default())?;
    let whole = begun.elapsed().as_secs_f64();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("VmHWM unknown");
    println!(
        "{strands} strands: planned {planned:.2} s, dressed {:.2} s, written {:.2} s ({} and {} MB), previewed {:.2} s; {whole:.2} s in all; {peak}",
        dressed - planned,
        written - dressed,
        bytes[0] / 1_000_000,
        bytes[1] / 1_000_000,
        whole - written
    );
    Ok(())
}

/// Counts what is written.
struct Count<'a>(&'a mut u64);

impl std::io::Write for Count<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        *self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

pub fn run() -> Result<(), Failure> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    // First, while nothing else has taken memory.
    moss()?;
    tables()?;
    surfaces();
    aggregate(quick)
}
