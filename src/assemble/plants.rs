//! Plants that several steps grew together get their widths and their form.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::memory::bytes_of;
use crate::grow::{Grown, Step};
use crate::math::{DVec3, Memory, OutOfMemory};
use crate::skeleton::{Plant, PlantPart};

/// The steps of each plant, in the order of growth, by the step where it starts; those that grew nothing are none.
fn members_of_plants(steps: &[Step], grown: &[Grown]) -> BTreeMap<usize, Vec<usize>> {
    // The step where each step's plant starts.
    let base = |mut i: usize| loop {
        match steps[i].width.starts_plant() {
            Some(false) => i = *steps[i].sources().first()?,
            Some(true) => return Some(i),
            None => return None,
        }
    };
    let mut plants: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    // In the order of growth: what a step grows from comes before it.
    let mut depth = vec![0; steps.len()];
    for _ in 0..steps.len() {
        for i in 0..steps.len() {
            depth[i] = steps[i].sources().iter().map(|&from| depth[from] + 1).max().unwrap_or(0);
        }
    }
    let mut order: Vec<usize> = (0..steps.len()).collect();
    order.sort_by_key(|&i| (depth[i], i));
    for i in order {
        if let Some(base) = base(i).filter(|&base| !grown[base].skeleton.nodes.is_empty()) {
            plants.entry(base).or_default().push(i);
        }
    }
    plants
}

/// Gives plants, which several steps grew together, their widths and their form, within `memory`.
///
/// # Errors
/// [`OutOfMemory`].
pub(super) fn shape_plants(steps: &[Step], grown: &mut [Grown], memory: &Memory) -> Result<(), OutOfMemory> {
    let plants = members_of_plants(steps, grown);
    let feet: Vec<(usize, Option<DVec3>)> = plants
        .iter()
        .flat_map(|(&base, members)| {
            let foot = grown[base].skeleton.nodes.first().map(|node| node.position);
            members.iter().map(move |&i| (i, foot))
        })
        .collect();
    let nodes = plants.values().flatten().map(|&i| grown[i].skeleton.nodes.len() as u64).sum::<u64>();
    let memory = memory.beside(bytes_of(&*grown));
    memory.ask(nodes * Plant::NODE_BYTES)?;
    let shaped: Vec<(Vec<usize>, Plant)> = plants
        .into_par_iter()
        .map(|(base, members)| {
            let parts: Vec<PlantPart<'_>> = members
                .iter()
                .map(|&i| PlantPart {
                    skeleton: &grown[i].skeleton,
                    width: &steps[i].width,
                    first_level: grown[i].first_level,
                })
                .collect();
            let mut plant = Plant::new(&parts);
            plant.thicken(&steps[base].width);
            if let Some(form) = &steps[base].form {
                plant.shape(form, &steps[base].width);
            }
            (members, plant)
        })
        .collect();
    // Their form has given them other nodes.
    memory.ask(shaped.iter().map(|(_, plant)| plant.bytes_to_split() as u64).sum())?;
    for (members, plant) in shaped {
        for (i, mut skeleton) in members.into_iter().zip(plant.split()) {
            skeleton.classes.clone_from(&steps[i].classes);
            skeleton.number_branches();
            grown[i].skeleton = skeleton;
        }
    }
    feet.into_iter().for_each(|(i, foot)| grown[i].foot = foot);
    Ok(())
}
