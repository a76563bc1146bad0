//! Merging of limbs that run side by side within each other's thickness.

use super::plant::Plant;

/// Nodes of the main limb, from the last match on, that are searched for the nearest.
const AHEAD: usize = 8;

impl Plant {
    /// From every fork on, merges nodes of a side limb into the main one while they are nearer to it than `share` of both radii;
    /// their children become children of the main limb's nodes. Ends of paths are kept.
    pub(super) fn merge(&mut self, share: f64) {
        let main = self.main_children();
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); self.nodes.len()];
        for (i, node) in (0_u32..).zip(&self.nodes) {
            if let Some(parent) = node.node.parent {
                children[parent as usize].push(i);
            }
        }
        let mut is_end = vec![false; self.nodes.len()];
        for end in &self.ends {
            is_end[end.path.end as usize] = true;
            is_end[end.path.root as usize] = true;
        }
        let mut is_gone = vec![false; self.nodes.len()];
        // From the root outwards: a merged limb may be merged again.
        let mut forks: Vec<u32> =
            (0..self.nodes.len() as u32).filter(|&i| self.nodes[i as usize].node.parent.is_none()).collect();
        while let Some(fork) = forks.pop() {
            let mut side: Vec<(u32, u32)> = children[fork as usize]
                .iter()
                .filter(|&&c| main[fork as usize] != Some(c))
                .map(|&c| (c, fork))
                .collect();
            let mut kept: Vec<u32> = main[fork as usize].into_iter().collect();
            while let Some((node, from)) = side.pop() {
                let p = self.nodes[node as usize].node.position;
                // The nearest node of the main limb, from the last match on.
                let chain = std::iter::successors(Some(from), |&at| main[at as usize]).take(AHEAD);
                let distance = |at: u32| self.nodes[at as usize].node.position.distance(p);
                let nearest = chain.fold(from, |best, at| if distance(at) < distance(best) { at } else { best });
                let is_within = distance(nearest)
                    < share * (self.nodes[nearest as usize].node.radius + self.nodes[node as usize].node.radius);
                if is_within && !is_end[node as usize] {
                    is_gone[node as usize] = true;
                    side.extend(children[node as usize].iter().map(|&child| (child, nearest)));
                } else {
                    self.nodes[node as usize].node.parent = Some(from);
                    if from == fork {
                        kept.push(node);
                    } else {
                        children[from as usize].push(node);
                    }
                }
            }
            children[fork as usize].clone_from(&kept);
            forks.extend(kept);
        }
        // Merged nodes have no children left, so the order of the others is unaffected.
        let stays: Vec<u32> = (0..self.nodes.len() as u32).filter(|&i| !is_gone[i as usize]).collect();
        self.keep(&stays);
        self.reorder();
    }
}
