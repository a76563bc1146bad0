//! `check`: every mistake in scenes, and whether they hold what they claim.

use super::args::CheckArgs;
use super::claims::Tallies;
use super::console::Console;
use super::error::Failure;
use super::jobs::Jobs;
use crate::scene::{self, check_claims};

pub fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let mut worst = None;
    let mut tallies = Tallies::default();
    let one_of_several = jobs.list.len() > args.scene.scenes.len();
    for job in &jobs.list {
        let progress = console.progress(job.name());
        let checked = jobs.load(job).and_then(|scene| {
            scene::check(&scene, &jobs.memory, &progress)?;
            Ok(scene)
        });
        let scene = match checked {
            Ok(scene) => scene,
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(failure) => {
                // The last failure is printed by whoever takes the result.
                if let Some(earlier) = worst.replace(failure) {
                    earlier.print(console);
                }
                continue;
            }
        };
        if !args.claims {
            if console.json {
                console.result(&serde_json::json!({ "scene": job.name(), "mistakes": [] }));
            } else {
                console.line(&format!("{}: good", job.name()));
            }
            continue;
        }
        let found = jobs
            .grow(&scene, &[], console, &progress)
            .and_then(|grown| Ok(check_claims(&scene, &grown, &jobs.memory, &progress)?));
        match found {
            Ok(findings) => {
                console.done();
                tallies.add(job, &scene, findings, one_of_several, console);
            }
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            // Other seeds may grow.
            Err(failure) => {
                console.note(&format!("{} does not grow: {}", job.name(), job.title()));
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
