//! `info`: the numbers of a scene.

use std::io;
use std::time::Instant;

use serde_json::json;

use super::args::InfoArgs;
use super::console::Console;
use super::error::Failure;
use super::jobs::Jobs;
use super::memory;
use crate::assemble::Recipe;
use crate::export::{Pov, Templates};
use crate::grow::Grown;
use crate::math::Memory;
use crate::scene;
use crate::skeleton::{Measurement, Orders, Plant, PlantPart, Skeleton, measure_from};

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
        // What threads free while they grow lies in their own rooms: it is not to be had again.
        let plants = whole_plants(&scene.recipe, &grown, &jobs.memory.beside(jobs.memory.most()))?;
        lap("plants");
        let model = scene::model(&scene, &grown, scene.recipe.size, &jobs.memory, &progress)?;
        lap("model");
        let mut count = Count::default();
        Pov::new(&model, &Templates::default(), "scene", scene.recipe.size, &job.origin(scene.recipe.seed, "info"))
            .write_inc(&mut count)
            .map_err(|e| Failure::Usage(e.to_string()))?;
        lap("export");

        if console.json {
            console.result(&json!({
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
                "plants": plants.iter().map(|(plant, _)| plant).collect::<Vec<_>>(),
                "claims": claims,
            }));
            continue;
        }
        console.line(&format!("{}: {} (seed {})", job.name(), scene.recipe.title, scene.recipe.seed));
        grown.iter().for_each(|step| print_step(step, console));
        plants.iter().for_each(|(plant, m)| print_plant(plant, m, console));
        print_whole(model.primitives(), count.0, jobs.memory.most(), &seconds, console);
    }
    Ok(())
}

/// What all of a scene takes.
fn print_whole(primitives: usize, bytes: u64, memory: u64, seconds: &[(&str, f64)], console: &Console) {
    let [bytes, memory] = [bytes, memory].map(|bytes| bytes as f64 / 1e6);
    console.line(&format!("  {primitives} primitives, {bytes:.1} MB as POV-Ray, {memory:.1} MB of memory at most"));
    let times: Vec<_> = seconds.iter().map(|(stage, s)| format!("{stage} {s:.3} s")).collect();
    console.line(&format!("  {}", times.join(", ")));
}

/// The numbers of a step.
fn step(step: &Grown) -> serde_json::Value {
    let mut all = measures("step", &step.name, &step.skeleton, &measure_from(&step.skeleton, step.foot));
    all["nodes"] = json!(step.nodes);
    all["edges"] = json!(step.edges);
    all["settled"] = json!(step.settled);
    all["dropped"] = json!(step.dropped);
    all
}

/// What is measured of a skeleton, which is a step's or an object's.
fn measures(of: &str, name: &str, skeleton: &Skeleton, m: &Measurement) -> serde_json::Value {
    json!({ of: name, "skeleton": m, "streams": streams(skeleton) })
}

/// What is measured of the plants of objects that several steps grew, each as one skeleton.
fn whole_plants(
    recipe: &Recipe,
    grown: &[Grown],
    memory: &Memory,
) -> Result<Vec<(serde_json::Value, Measurement)>, Failure> {
    let mut plants = Vec::new();
    for object in recipe.objects.iter().filter(|object| object.steps.len() > 1) {
        let nodes = object.steps.iter().map(|&i| grown[i].skeleton.nodes.len() as u64).sum::<u64>();
        let asked = memory.ask(nodes * Plant::WHOLE_BYTES);
        asked.map_err(|error| Failure::Usage(format!("measuring the plant needs {error}: raise --max-memory")))?;
        let part = |&i: &usize| PlantPart {
            skeleton: &grown[i].skeleton,
            width: &recipe.steps[i].width,
            first_level: grown[i].first_level,
        };
        let parts: Vec<PlantPart<'_>> = object.steps.iter().map(part).collect();
        let plant = Plant::new(&parts).whole();
        if !plant.nodes.is_empty() {
            let m = measure_from(&plant, None);
            plants.push((measures("object", &object.name, &plant, &m), m));
        }
    }
    Ok(plants)
}

fn print_step(step: &Grown, console: &Console) {
    let m = measure_from(&step.skeleton, step.foot);
    console.line(&format!(
        "  {}: {} nodes, {} edges, {} settled; {} endpoints, {} dropped; {} skeleton nodes, tortuosity {:.3}, spread {:.3}",
        step.name, step.nodes, step.edges, step.settled, m.endpoints, step.dropped, m.nodes, m.tortuosity, m.spread
    ));
    print_orders(&m, console);
}

fn print_plant(plant: &serde_json::Value, m: &Measurement, console: &Console) {
    let name = plant["object"].as_str().unwrap_or_default();
    console.line(&format!(
        "  object {name}, all its steps: {} endpoints, {} skeleton nodes, tortuosity {:.3}, spread {:.3}",
        m.endpoints, m.nodes, m.tortuosity, m.spread
    ));
    print_orders(m, console);
}

fn print_orders(m: &Measurement, console: &Console) {
    console.line(&format!(
        "    {} orders of Strahler, bifurcation ratio {:.2}, twigs {:.3} long, width by length to the {:.2}, dimension {:.2}",
        m.strahler, m.bifurcation, m.twig, m.width_exponent, m.dimension
    ));
}

/// How many limbs of each order of Strahler there are, and how long they are on average.
fn streams(skeleton: &Skeleton) -> serde_json::Value {
    let orders = Orders::new(skeleton);
    let each = orders.streams.iter().zip(&orders.lengths);
    each.map(|(count, length)| json!({ "count": count, "mean_length": length })).collect()
}
