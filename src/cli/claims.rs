//! `check --claims`: what was found of every claim, and over several runs of a scene how often it held and where it came nearest
//! to failing.

use super::console::Console;
use super::jobs::Job;
use crate::scene::{Finding, Loaded};

/// What was found of one claim in all runs of a scene.
struct Tally {
    scene: String,
    runs: usize,
    held: usize,
    /// The finding with the least margin, and its seed.
    worst: (Finding, u64),
}

/// What was found in all runs of a call.
#[derive(Default)]
pub struct Tallies {
    all: Vec<Tally>,
    broken: Vec<String>,
}

impl Tallies {
    /// Adds the findings of a run, and says them, or keeps them for the summary where the run is one of several.
    pub fn add(&mut self, job: &Job, scene: &Loaded, findings: Vec<Finding>, one_of_several: bool, console: &Console) {
        let seed = scene.recipe.seed;
        for finding in findings {
            if console.json {
                console.result(&serde_json::json!({ "scene": job.name(), "seed": seed, "finding": finding }));
            } else if !one_of_several {
                console.line(&format!("{}: {}", job.name(), told(&finding)));
            }
            if !finding.holds {
                let run =
                    if one_of_several { format!("{} ({})", job.name(), job.title()) } else { job.name().to_owned() };
                self.broken.push(format!("{run}: {}", finding.claim));
            }
            self.count(job.name(), seed, finding);
        }
    }

    /// Counts a finding.
    fn count(&mut self, scene: &str, seed: u64, finding: Finding) {
        let known = self.all.iter_mut().find(|tally| tally.scene == scene && tally.worst.0.claim == finding.claim);
        let held = usize::from(finding.holds);
        let Some(tally) = known else {
            self.all.push(Tally { scene: scene.to_owned(), runs: 1, held, worst: (finding, seed) });
            return;
        };
        tally.runs += 1;
        tally.held += held;
        if finding.margin < tally.worst.0.margin {
            tally.worst = (finding, seed);
        }
    }

    /// Says of each claim with several runs how often it held.
    pub fn sum_up(&self, console: &Console) {
        for Tally { scene, runs, held, worst: (finding, seed) } in self.all.iter().filter(|tally| tally.runs > 1) {
            if console.json {
                console.result(&serde_json::json!({
                    "scene": scene, "claim": finding.claim, "runs": runs, "held": held,
                    "worst": { "seed": seed, "finding": finding },
                }));
            } else {
                let word = if held == runs { "holds" } else { "DOES NOT HOLD" };
                console.line(&format!(
                    "{scene}: {} {word} in {held} of {runs} runs, at worst {:.4} with seed {seed}: {} ({})",
                    finding.claim, finding.measured, finding.against, finding.says
                ));
            }
        }
    }

    /// The claims that did not hold, and in which run.
    pub fn broken(&self) -> &[String] {
        &self.broken
    }
}

/// A finding as a line.
fn told(finding: &Finding) -> String {
    let word = if finding.holds { "holds" } else { "DOES NOT HOLD" };
    format!("{} {word}: {:.4}, {} ({})", finding.claim, finding.measured, finding.against, finding.says)
}
