//! `check`: every mistake in scenes, and whether they hold what they claim.

use super::args::CheckArgs;
use super::claims::Tallies;
use super::console::Console;
use super::error::Failure;
use super::jobs::{Job, Jobs};
use crate::math::Progress;
use crate::scene::{self, Finding, Loaded, check_claims};

pub fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let mut worst: Option<Failure> = None;
    let mut tallies = Tallies::default();
    let one_of_several = jobs.list.len() > args.scene.scenes.len();
    for job in &jobs.list {
        let outcome = jobs.load(job).and_then(|scene| {
            let progress = console.progress(job.name());
            if args.claims {
                let findings = findings(&jobs, job, &scene, console, &progress)?;
                console.done();
                tallies.add(job, &scene, findings, one_of_several, console);
            } else {
                scene::check(&scene, &jobs.memory, &progress)?;
                tell_good(job, console);
            }
            Ok(())
        });
        match outcome {
            Ok(()) => {}
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            // Other scenes may be good, and other seeds grow. The last failure is printed by whoever takes the result.
            Err(failure) => {
                if let Some(earlier) = worst.replace(failure) {
                    earlier.print(console);
                }
            }
        }
    }
    tallies.sum_up(console);
    match worst {
        Some(failure) => Err(failure),
        None if tallies.broken().is_empty() => Ok(()),
        None => Err(Failure::No(format!("claims that do not hold: {}", tallies.broken().join(", ")))),
    }
}

fn tell_good(job: &Job, console: &Console) {
    if console.json {
        console.result(&serde_json::json!({ "scene": job.name(), "mistakes": [] }));
    } else {
        console.line(&format!("{}: good", job.name()));
    }
}

/// Grows `scene` and measures what it claims. Growing finds its first mistake: only then are all of them looked for.
fn findings(
    jobs: &Jobs,
    job: &Job,
    scene: &Loaded,
    console: &Console,
    progress: &Progress,
) -> Result<Vec<Finding>, Failure> {
    let found = jobs
        .grow(scene, &[], console, progress)
        .and_then(|grown| Ok(check_claims(scene, &grown, &jobs.memory, progress)?));
    if !matches!(found, Ok(_) | Err(Failure::Stopped)) {
        scene::check(scene, &jobs.memory, progress)?;
        console.note(&format!("{} does not grow: {}", job.name(), job.title()));
    }
    found
}
