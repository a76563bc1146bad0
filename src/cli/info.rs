//! `info`: the numbers of a scene.

use std::io;
use std::time::Instant;

use serde_json::json;

use super::args::InfoArgs;
use super::console::Console;
use super::error::Failure;
use super::jobs::Jobs;
use super::memory;
use crate::export::{Pov, Templates};
use crate::grow::Grown;
use crate::scene;
use crate::skeleton::{Orders, Skeleton, measure_from};

/// A writer that counts.
#[derive(Default)]
struct Count(u64);

impl io::Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

pub fn run(args: &InfoArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    for job in &jobs.list {
        let mut seconds = Vec::new();
        let mut clock = Instant::now();
        let mut lap = |stage: &'static str| {
            seconds.push((stage, clock.elapsed().as_secs_f64()));
            clock = Instant::now();
        };
        let scene = jobs.load(job)?;
        lap("load");
        let progress = console.progress(job.name());
        let grown = jobs.grow(&scene, &[], console, &progress)?;
        lap("grow");
        // They may grow other seeds, and are printed as JSON alone.
        let claims =
            if console.json { scene::check_claims(&scene, &grown, &jobs.memory, &progress)? } else { Vec::new() };
        console.done();
        lap("claims");
        let model = scene::model(&scene, &grown, scene.recipe.size, &jobs.memory, &progress)?;
        lap("model");
        let mut count = Count::default();
        Pov::new(&model, &Templates::default(), "scene", scene.recipe.size, &job.origin(scene.recipe.seed, "info"))
            .write_inc(&mut count)
            .map_err(|e| Failure::Usage(e.to_string()))?;
        lap("export");

        let all = json!({
            "scene": job.name(),
            "title": scene.recipe.title,
            "seed": scene.recipe.seed,
            "nodes": grown.iter().map(|s| s.nodes).sum::<u64>(),
            "edges": grown.iter().map(|s| s.edges).sum::<u64>(),
            "endpoints": grown.iter().map(|s| s.skeleton.paths.len()).sum::<usize>(),
            "primitives": model.primitives(),
            "bytes": { "needed": jobs.memory.most(), "pov": count.0 },
            "memory": memory::told(&jobs.memory),
            "seconds": seconds.iter().map(|(stage, s)| ((*stage).to_owned(), json!(s))).collect::<serde_json::Map<_, _>>(),
            "steps": grown.iter().map(step).collect::<Vec<_>>(),
            "claims": claims,
        });
        if console.json {
            console.result(&all);
            continue;
        }
        console.line(&format!("{}: {} (seed {})", job.name(), scene.recipe.title, scene.recipe.seed));
        grown.iter().for_each(|step| print_step(step, console));
        console.line(&format!(
            "  {} primitives, {:.1} MB as POV-Ray, {:.1} MB of memory at most",
            model.primitives(),
            count.0 as f64 / 1e6,
            jobs.memory.most() as f64 / 1e6
        ));
        let times: Vec<_> = seconds.iter().map(|(stage, s)| format!("{stage} {s:.3} s")).collect();
        console.line(&format!("  {}", times.join(", ")));
    }
    Ok(())
}

/// The numbers of a step.
fn step(step: &Grown) -> serde_json::Value {
    json!({
        "step": step.name,
        "nodes": step.nodes,
        "edges": step.edges,
        "settled": step.settled,
        "dropped": step.dropped,
        "skeleton": measure_from(&step.skeleton, step.foot),
        "streams": streams(&step.skeleton),
    })
}

fn print_step(step: &Grown, console: &Console) {
    let m = measure_from(&step.skeleton, step.foot);
    console.line(&format!(
        "  {}: {} nodes, {} edges, {} settled; {} endpoints, {} dropped; {} skeleton nodes, tortuosity {:.3}, spread {:.3}",
        step.name, step.nodes, step.edges, step.settled, m.endpoints, step.dropped, m.nodes, m.tortuosity, m.spread
    ));
    console.line(&format!(
        "    {} orders of Strahler, bifurcation ratio {:.2}, twigs {:.3} long, dimension {:.2}",
        m.strahler, m.bifurcation, m.twig, m.dimension
    ));
}

/// How many limbs of each order of Strahler there are, and how long they are on average.
fn streams(skeleton: &Skeleton) -> serde_json::Value {
    let orders = Orders::new(skeleton);
    let each = orders.streams.iter().zip(&orders.lengths);
    each.map(|(count, length)| json!({ "count": count, "mean_length": length })).collect()
}
