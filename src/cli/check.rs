//! `check`: every mistake in scenes, and whether they hold what they claim.

use super::args::CheckArgs;
use super::console::Console;
use super::error::Failure;
use super::jobs::Jobs;
use crate::scene::{self, check_claims};

pub fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let jobs = Jobs::new(&args.scene, console)?;
    let mut worst = None;
    let mut broken = Vec::new();
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
        let grown = jobs.grow(&scene, &[], console, &progress)?;
        console.done();
        for finding in check_claims(&scene, &grown) {
            if console.json {
                console.result(&serde_json::json!({ "scene": job.name(), "finding": finding }));
            } else {
                let word = if finding.holds { "holds" } else { "DOES NOT HOLD" };
                console.line(&format!(
                    "{}: {} {word}: {:.4}, {} ({})",
                    job.name(),
                    finding.claim,
                    finding.measured,
                    finding.against,
                    finding.says
                ));
            }
            if !finding.holds {
                broken.push(format!("{}: {}", job.name(), finding.claim));
            }
        }
    }
    match worst {
        Some(failure) => Err(failure),
        None if broken.is_empty() => Ok(()),
        None => Err(Failure::No(format!("claims that do not hold: {}", broken.join(", ")))),
    }
}
