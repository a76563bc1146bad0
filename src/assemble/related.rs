//! Which steps a step depends on, and which depend on it.

use crate::grow::Step;

/// For each of `steps` whether what it grows has to do with one of `wanted`: it grows from it, near it, in its shape or its
/// space, or the other way round, in any number of turns. All do where a step looks for light, which any other may take.
pub(super) fn related(steps: &[Step], wanted: &[usize]) -> Vec<bool> {
    let looks =
        |step: &Step| step.repeat.as_ref().is_some_and(|repeat| repeat.influences.iter().any(|i| i.clump().is_some()));
    if steps.iter().any(looks) {
        return vec![true; steps.len()];
    }
    let mut is_related = vec![false; steps.len()];
    let mut waiting = wanted.to_vec();
    while let Some(at) = waiting.pop() {
        if std::mem::replace(&mut is_related[at], true) {
            continue;
        }
        waiting.extend(steps[at].after());
        let others = (0..steps.len()).filter(|&i| steps[i].after().any(|before| before == at));
        waiting.extend(others.chain((0..steps.len()).filter(|&i| steps[i].shares_space(&steps[at]))));
    }
    is_related
}
