//! Stream orders of Horton (1945) and Strahler (1957).

use super::Skeleton;

/// The streams of a skeleton by Strahler order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orders {
    /// The number of streams of each order, from order 1 on. A stream extends from the confluence of two streams of the order
    /// below to that with one of its own or a higher order.
    pub streams: Vec<usize>,
    /// Mean length of the streams of each order, in scene units.
    pub lengths: Vec<f64>,
}

impl Orders {
    /// The orders of `skeleton`: 1 for tips, n + 1 where two of order n meet.
    #[must_use]
    pub fn new(skeleton: &Skeleton) -> Self {
        let nodes = &skeleton.nodes;
        // The highest order of the children, and how many have it.
        let mut highest: Vec<(u32, u32)> = vec![(0, 0); nodes.len()];
        let mut orders = vec![0_u32; nodes.len()];
        for i in (0..nodes.len()).rev() {
            orders[i] = match highest[i] {
                (0, _) => 1,
                (order, 1) => order,
                (order, _) => order + 1,
            };
            if let Some(parent) = nodes[i].parent {
                let best = &mut highest[parent as usize];
                if orders[i] > best.0 {
                    *best = (orders[i], 1);
                } else if orders[i] == best.0 {
                    best.1 += 1;
                }
            }
        }
        let most = orders.iter().copied().max().unwrap_or(0) as usize;
        let mut all = Self { streams: vec![0; most], lengths: vec![0.0; most] };
        for (i, node) in nodes.iter().enumerate() {
            let order = orders[i] as usize - 1;
            let parent = node.parent.map(|p| p as usize);
            // A root without children is no stream.
            if parent.is_none_or(|p| orders[p] != orders[i]) && (parent.is_some() || highest[i].0 > 0) {
                all.streams[order] += 1;
            }
            all.lengths[order] += parent.map_or(0.0, |p| (node.position - nodes[p].position).length());
        }
        for (length, &count) in all.lengths.iter_mut().zip(&all.streams) {
            *length /= count.max(1) as f64;
        }
        all
    }

    /// The Strahler number: the order of the root.
    #[must_use]
    pub fn highest(&self) -> usize {
        self.streams.len()
    }

    /// The bifurcation ratio: the number of streams of an order over that of the next, geometric mean. Trees have 3 to 5; 0
    /// where there is one order only.
    #[must_use]
    pub fn bifurcation(&self) -> f64 {
        match self.streams[..] {
            [first, .., last] if last > 0 => {
                let steps = self.streams.len() as f64 - 1.0;
                libm::exp(libm::log(first as f64 / last as f64) / steps)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::tests::skeleton;
    use super::*;

    #[test]
    fn orders_follow_strahler() {
        // Two forks of two tips each meet; another tip joins the stem below.
        let tree = skeleton(&[
            &[(0, 4), (1, 3), (2, 2), (2, 1), (2, 0)],
            &[(2, 4), (1, 3), (2, 2), (2, 1), (2, 0)],
            &[(3, 4), (4, 3), (2, 2), (2, 1), (2, 0)],
            &[(5, 4), (4, 3), (2, 2), (2, 1), (2, 0)],
            &[(9, 2), (2, 1), (2, 0)],
        ]);
        let orders = Orders::new(&tree);
        assert_eq!(orders.streams, [5, 2, 1]);
        assert_eq!(orders.highest(), 3);
        assert!((orders.bifurcation() - libm::sqrt(5.0)).abs() < 1e-12);
        assert!((orders.lengths[2] - 2.0).abs() < 1e-12);
        assert_eq!(Orders::new(&skeleton(&[&[(0, 0)]])).streams, [0]);
    }
}
