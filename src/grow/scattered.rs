//! One growth step among scattered nodes (Xu and Mould 2012, section 3.1).

use std::collections::HashMap;

use super::choice::choose;
use super::construction::scattered_marks;
use super::{GrowError, Grown, MarkKind, Placement, ScatterSpace, Source, Step, Unreached};
use crate::geom::Shape;
use crate::graph::{EdgeWeights, Node, Scatter};
use crate::math::{DVec3, Progress, Stream};
use crate::plan::{Routes, routes};
use crate::skeleton::Skeleton;

/// Paths on their way into a skeleton.
struct Paths<'a> {
    graph: &'a Scatter,
    weights: &'a EdgeWeights,
    spacing: f64,
    /// Where nodes are that were told exactly.
    exact: HashMap<Node, DVec3>,
    known: HashMap<Node, u32>,
    skeleton: Skeleton,
}

impl Paths<'_> {
    /// Adds the path to `end`, whose generator starts with the cost `before`.
    fn add(&mut self, found: &Routes, end: Node, class: u16, before: f64) {
        let path = found.path(end).map(|(node, cost)| {
            let p = self.exact.get(&node).copied().unwrap_or_else(|| self.graph.position(node));
            (node, p, before + self.weights.real(cost) * self.spacing)
        });
        self.skeleton.add_path(&mut self.known, class, path);
    }
}

impl Step {
    /// Grows the step once in `space`.
    pub(super) fn grow_scattered(
        &self,
        space: &ScatterSpace,
        seed: u64,
        grown: &[Option<&Skeleton>],
        show: &[MarkKind],
        progress: &Progress,
    ) -> Result<Grown, GrowError> {
        let in_space =
            |message: String| GrowError::Scene { place: format!("space.{}.nodes", self.space_name), message };
        let is_open = |p: DVec3| {
            let volumes = space.clusters.as_ref().map_or(f64::INFINITY, |c| c.inside.margin(p) - c.radius);
            let margin = space.shape.margin(p).min(volumes);
            margin <= space.spacing && space.forbid.as_ref().is_none_or(|forbid| !forbid.contains(p))
        };
        let mut starts = self.start_places(grown)?;
        if matches!(self.source, Source::Steps(..)) {
            // As on a lattice: only what lies in the space.
            starts.retain(|&p| is_open(p));
            if starts.is_empty() {
                let message = "nothing of that step lies in the space".to_owned();
                return Err(GrowError::Scene { place: format!("grow.{}.from", self.name), message });
            }
        }
        let mut fixed = starts.clone();
        for set in &self.endpoints {
            match &set.placement {
                Placement::At(points) => fixed.extend(points),
                Placement::Through(lists) => fixed.extend(lists.iter().flatten()),
                Placement::Random { .. } | Placement::Near(_) => {}
            }
        }
        if let Some(i) = fixed.iter().position(|&p| !is_open(p)) {
            let message = format!("the point {} is outside the space or where nodes are forbidden", fixed[i]);
            let key = if i < starts.len() { "from" } else { "to" };
            return Err(GrowError::Scene { place: format!("grow.{}.{key}", self.name), message });
        }
        let table = space.table().map_err(|error| GrowError::Scene {
            place: format!("space.{}.weights", self.space_name),
            message: error.to_string(),
        })?;
        let scattered = space.scatter(&table, seed, &fixed).map_err(|error| in_space(error.to_string()))?;
        let graph = &scattered.graph;
        let weights = &scattered.weights;
        let nearest = |points: &[DVec3]| graph.nearest(points);
        let mut generators: Vec<(Node, u64)> = Vec::new();
        if let Source::Inside(shape) = &self.source {
            let is_in = |node: &Node| shape.contains(graph.position(*node));
            generators.extend((0..graph.len() as u32).map(Node).filter(is_in).map(|node| (node, 0)));
            if generators.is_empty() {
                let message = "no node of the space lies in this shape".to_owned();
                return Err(GrowError::Scene { place: format!("grow.{}.from", self.name), message });
            }
        }
        let mut exact = HashMap::new();
        for (node, p) in nearest(&starts).into_iter().zip(&starts) {
            // Of several places about a node the first.
            if exact.try_insert_first(node, *p) {
                generators.push((node, 0));
            }
        }
        let mut taken = vec![false; graph.len()];
        generators.iter().for_each(|&(node, _)| taken[node.0 as usize] = true);
        let mut wanted: Vec<(Node, u16, &str)> = Vec::new();
        let mut lists: Vec<(Vec<Node>, u16)> = Vec::new();
        for set in &self.endpoints {
            let wrong =
                |message: String| GrowError::Scene { place: format!("grow.{}.to.{}", self.name, set.name), message };
            match &set.placement {
                Placement::At(points) => {
                    for (node, p) in nearest(points).into_iter().zip(points) {
                        exact.try_insert_first(node, *p);
                        taken[node.0 as usize] = true;
                        wanted.push((node, set.class, &set.name));
                    }
                }
                Placement::Through(through) => {
                    for points in through {
                        let nodes = nearest(points);
                        for (node, p) in nodes.iter().zip(points) {
                            exact.try_insert_first(*node, *p);
                            taken[node.0 as usize] = true;
                        }
                        lists.push((nodes, set.class));
                    }
                }
                Placement::Random { count, inside, apart, shell, stream } => {
                    let count = count.at(0) as u32;
                    let inside = inside.as_ref().or(scattered.spheres.is_empty().then_some(&space.shape));
                    let fits = |p: DVec3| {
                        let is_in = |s: &Shape| s.contains(p) && shell.is_none_or(|d| s.depth(p) <= d);
                        inside.map_or_else(|| scattered.spheres.iter().any(is_in), is_in)
                    };
                    let stream = Stream::new(seed, &format!("endpoints/{stream}"));
                    let chosen = choose(graph, &mut taken, count, *apart, fits, &stream);
                    if chosen.len() < count as usize {
                        return Err(wrong(format!(
                            "only {} of {count} endpoints could be placed: make `inside` larger, `apart` ({apart}) or the spacing smaller, or ask for fewer",
                            chosen.len()
                        )));
                    }
                    wanted.extend(chosen.into_iter().map(|node| (node, set.class, set.name.as_str())));
                }
                Placement::Near(near) => {
                    let places = near.draw_places(seed, grown, space.is_plane).map_err(wrong)?;
                    let nodes = nearest(&places);
                    for node in nodes {
                        if !std::mem::replace(&mut taken[node.0 as usize], true) {
                            wanted.push((node, set.class, &set.name));
                        }
                    }
                }
            }
        }
        let nodes: Vec<Node> = wanted.iter().map(|&(node, ..)| node).collect();
        self.delay(graph, weights, &mut generators, &exact, grown, progress)?;
        let mut paths = Paths {
            graph,
            weights,
            spacing: space.spacing,
            exact,
            known: HashMap::new(),
            skeleton: Skeleton::new(self.classes.clone()),
        };
        let mut settled = 0;
        let mut dropped = 0;
        let mut unreached = |node: Node, set: &str| {
            dropped += 1;
            if self.unreached == Unreached::Drop {
                return Ok(());
            }
            Err(GrowError::Scene {
                place: format!("grow.{}.to.{set}", self.name),
                message: format!(
                    "no path reaches the endpoint at {}: is the shape in pieces? Join them, or set `unreached = \"drop\"`",
                    graph.position(node)
                ),
            })
        };
        // Ways through given places come first, leg by leg; each leg starts where the one before ended.
        for (list, class) in &lists {
            let mut from = generators.clone();
            let mut before = 0.0;
            let kept = paths.skeleton.paths.len();
            for &node in list {
                let found = routes(graph, weights, &from, &[node], progress)?;
                settled += found.settled() as u64;
                if let Some(cost) = found.cost(node) {
                    paths.add(&found, node, *class, before);
                    before += weights.real(cost) * space.spacing;
                } else {
                    // What comes after it would hang in the air.
                    unreached(node, "through")?;
                    break;
                }
                from = vec![(node, 0)];
            }
            // Only the last place is an endpoint.
            let last = paths.skeleton.paths.pop();
            paths.skeleton.paths.truncate(kept);
            paths.skeleton.paths.extend(last);
        }
        if !nodes.is_empty() || lists.is_empty() {
            // What the given ways have made is there already.
            let found = routes(graph, weights, &generators, &nodes, progress)?;
            settled += found.settled() as u64;
            for &(node, class, set) in &wanted {
                if found.cost(node).is_none() {
                    unreached(node, set)?;
                    continue;
                }
                paths.add(&found, node, class, 0.0);
            }
        }
        let skeleton = paths.skeleton;
        let mut shapes: Vec<&Shape> = vec![&space.shape];
        shapes.extend(&space.forbid);
        shapes.extend(&scattered.volumes);
        shapes.extend(self.endpoints.iter().filter_map(|set| match &set.placement {
            Placement::Random { inside, .. } => inside.as_ref(),
            _ => None,
        }));
        let ends: Vec<Node> =
            nodes.iter().copied().chain(lists.iter().filter_map(|(list, _)| list.last().copied())).collect();
        let marks = scattered_marks(graph, &shapes, &ends, show).map_err(in_space)?;
        Ok(Grown {
            name: self.name.clone(),
            foot: None,
            first_level: self.first_level(grown),
            nodes: graph.len() as u64,
            edges: graph.count_edges(),
            settled,
            marks,
            regions: None,
            skeleton: self.finish(skeleton, grown)?,
            dropped,
        })
    }

    /// Where paths start.
    fn start_places(&self, grown: &[Option<&Skeleton>]) -> Result<Vec<DVec3>, GrowError> {
        let wrong =
            |message: &str| GrowError::Scene { place: format!("grow.{}.from", self.name), message: message.to_owned() };
        let places = match &self.source {
            Source::At(points) => points.clone(),
            // Known once there are nodes.
            // Random ones are refused for scattered nodes.
            Source::Inside(_) | Source::Spread(_) => return Ok(Vec::new()),
            Source::Steps(steps, part) => {
                let mut places = Vec::new();
                for &step in steps {
                    let skeleton = grown[step].ok_or_else(|| wrong("the step has not grown"))?;
                    places.extend(skeleton.places(*part));
                }
                places
            }
        };
        if places.is_empty() { Err(wrong("nothing of that step lies in the space")) } else { Ok(places) }
    }

    /// Gives each generator the cost of going to it along the step that this one grows from.
    fn delay(
        &self,
        graph: &Scatter,
        weights: &EdgeWeights,
        generators: &mut [(Node, u64)],
        exact: &HashMap<Node, DVec3>,
        grown: &[Option<&Skeleton>],
        progress: &Progress,
    ) -> Result<(), GrowError> {
        let along = self.ways_along(grown);
        let (Some(&(first, _)), false) = (generators.first(), along.is_empty()) else { return Ok(()) };
        // What paths pay for a length here.
        let found = routes(graph, weights, &[(first, 0)], &[], progress)?;
        let (mut cost, mut length) = (0.0, 0.0);
        for i in 0..graph.len() as u32 {
            if let Some(paid) = found.cost(Node(i)) {
                cost += paid as f64;
                length += graph.position(Node(i)).distance(graph.position(first));
            }
        }
        let scale = self.along * cost / f64::max(length, f64::MIN_POSITIVE);
        for (node, start) in generators {
            let way = exact.get(node).and_then(|p| along.get(&p.to_array().map(f64::to_bits)));
            *start = way.map_or(0, |way| (way * scale) as u64);
        }
        Ok(())
    }
}

/// Keeps the first of several values.
trait InsertFirst {
    /// Inserts where nothing is yet, and tells whether it did.
    fn try_insert_first(&mut self, node: Node, p: DVec3) -> bool;
}

impl InsertFirst for HashMap<Node, DVec3> {
    fn try_insert_first(&mut self, node: Node, p: DVec3) -> bool {
        let before = self.len();
        self.entry(node).or_insert(p);
        self.len() > before
    }
}
