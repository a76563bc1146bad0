//! Growth by segments and by voxels: what they name is looked up, and how much will grow is told before it does.

use super::resolve::Resolver;
use crate::geom::Shape;
use crate::grow::{
    Attractor, AttractorSpec, Automaton, Branches, BranchesSpec, Cling, EndpointSpec, Expected, FromSpec, LightSense,
    MOST_NODES, MethodSpec, Segments, SegmentsSpec, Space, StepSpec, VoxelsSpec,
};
use crate::math::{DVec3, Degrees, Point};

/// Foliage that reaches farther, in voxels, is refused: every node fills so many to all sides.
const MOST_FOLIAGE: f64 = 24.0;

impl Resolver<'_> {
    /// Least and greatest, in order and in radians.
    fn angles(&mut self, place: &str, [least, most]: [Degrees; 2]) -> [f64; 2] {
        self.in_order(place, [least.0, most.0]);
        [least.radians(), most.radians()]
    }

    fn in_order(&mut self, place: &str, [least, most]: [f64; 2]) {
        if least > most {
            self.wrong(place, format!("the least comes first: [{most}, {least}]"));
        }
    }

    fn heading(&mut self, place: &str, heading: Option<Point>) -> DVec3 {
        let way = heading.map_or(DVec3::Z, |p| p.0);
        if way.try_normalize().is_none() {
            self.wrong(place, "a heading is a direction, not the zero vector".to_owned());
        }
        way.normalize_or(DVec3::Z)
    }

    fn branches(&mut self, place: &str, spec: Option<BranchesSpec>) -> Option<Branches> {
        let BranchesSpec { most, chance, angle, arc } = spec?;
        Some(Branches { most, chance, angle: self.angles(&format!("{place}.angle"), angle), arc: arc.radians() })
    }

    /// Growth by segments of the step at `place`.
    pub(super) fn segments(&mut self, place: &str, step: &StepSpec, spec: &SegmentsSpec) -> Option<Segments> {
        let at = |key: &str| format!("{place}.by.segments.{key}");
        let is_along = matches!(step.from, FromSpec::All(_));
        if is_along && spec.sprout.is_none() {
            let message = "how many limbs start along a step is told by `by.segments.sprout`; or grow `from.ends`";
            self.wrong(&format!("{place}.from.all"), message.to_owned());
        } else if !is_along && spec.sprout.is_some() {
            self.wrong(&at("sprout"), "limbs sprout along a step: this needs `from.all`".to_owned());
        }
        if let FromSpec::At(points) = &step.from
            && points.len() as f64 > 1e6
        {
            self.wrong(&format!("{place}.from.at"), "a million starts at most".to_owned());
        }
        self.free(place, step);
        let segments = Segments {
            step: spec.step,
            depth: spec.depth,
            jitter: self.angles(&at("jitter"), spec.jitter),
            branches: self.branches(&at("branches"), spec.branches),
            sprout: self.branches(&at("sprout"), spec.sprout),
            along: match &step.from {
                FromSpec::All(from) => self.scene.grow.get(&from.name).and_then(|before| match &before.by {
                    MethodSpec::Segments(before) => Some(before.step),
                    _ => None,
                }),
                _ => None,
            },
            heading: self.heading(&at("heading"), spec.heading),
            inside: match &spec.inside {
                Some(inside) => Some(self.shape(&at("inside"), inside)?),
                None => None,
            },
            toward: step.toward.as_ref().map(attractor),
            starts: self.starts(step),
        };
        let expected = segments.check(segments.starts);
        self.note(&format!("{place}.by.segments"), expected)?;
        Some(segments)
    }

    /// Growth by voxels of the step at `place`.
    pub(super) fn voxels(
        &mut self,
        place: &str,
        step: &StepSpec,
        spec: &VoxelsSpec,
        space: Option<&Space>,
    ) -> Option<Automaton> {
        let at = |key: &str| format!("{place}.by.voxels.{key}");
        if let FromSpec::All(_) = &step.from {
            self.wrong(&format!("{place}.from.all"), "limbs in voxels start at points or at ends".to_owned());
        }
        self.free(place, step);
        if let Some(Space::Voxels(space)) = space
            && spec.foliage > MOST_FOLIAGE * space.side
        {
            let message = format!("foliage reaches {MOST_FOLIAGE} voxels at most: {}", MOST_FOLIAGE * space.side);
            self.wrong(&at("foliage"), message);
        }
        let branches = spec.branches.map(|branches| {
            self.in_order(&at("branches.age"), branches.age.map(f64::from));
            (branches.age, self.angles(&at("branches.angle"), branches.angle))
        });
        let light = LightSense::new(&spec.light);
        if let Some(sun) = &spec.light.sun {
            self.in_order(&at("light.sun.hours"), sun.hours);
            if sun.directions().is_empty() {
                self.wrong(&at("light.sun"), "the sun is below the horizon at these hours of that day".to_owned());
            }
        }
        // Meshes are sampled at every voxel.
        let sampled = |shape: Shape| match space {
            Some(Space::Voxels(space)) => shape.sampled(space.side),
            _ => shape,
        };
        let cling = match &spec.cling {
            Some(cling) => {
                self.in_order(&at("cling.within"), cling.within);
                Some(Cling { to: sampled(self.shape(&at("cling.to"), &cling.to)?), within: cling.within })
            }
            None => None,
        };
        let keep_from = match &spec.keep_from {
            Some(keep) => Some((sampled(self.shape(&at("keep_from.shape"), &keep.shape)?), keep.by)),
            None => None,
        };
        Some(Automaton {
            step: spec.step,
            rounds: spec.rounds,
            nodes: spec.nodes,
            tries: spec.tries,
            turn: self.angles(&at("turn"), spec.turn),
            branches,
            apart: spec.apart.unwrap_or(spec.step * 0.5),
            room: spec.room,
            straight: spec.straight,
            light,
            foliage: spec.foliage,
            cling,
            keep_from,
            heading: self.heading(&at("heading"), spec.heading),
            toward: step.toward.as_ref().map(attractor),
        })
    }

    /// What holds where no graph carries limbs.
    fn free(&mut self, place: &str, step: &StepSpec) {
        if let FromSpec::Inside(_) | FromSpec::Spread(_) = &step.from {
            let message =
                "a graph has nodes in a shape or at random: without one limbs start at points (`from.at`) or ends";
            self.wrong(&format!("{place}.from"), message.to_owned());
        }
        if self.is_flat() {
            self.wrong(&format!("{place}.by"), "this grows in space, not in a flat scene".to_owned());
        }
    }

    /// Are all steps together, with their symmetries, within what there may be?
    pub(super) fn check_expected(&mut self) {
        let scene = self.scene;
        let all: f64 = scene.grow.keys().map(|name| self.expected(name).nodes).sum();
        if all > MOST_NODES as f64 {
            let message = format!(
                "{all:.2e} nodes are to be expected of all steps by segments, more than {MOST_NODES}: lower `depth`, `most` or `chance`"
            );
            self.wrong("grow", message);
        }
    }

    /// How many limbs of a step are expected to start.
    fn starts(&mut self, step: &StepSpec) -> f64 {
        match &step.from {
            FromSpec::At(points) => points.len() as f64,
            FromSpec::Ends(from) => self.expected(&from.name).ends,
            FromSpec::EveryEnd(all) => all.iter().map(|from| self.expected(&from.name).ends).sum(),
            FromSpec::All(from) => {
                let expected = self.expected(&from.name);
                (expected.nodes - expected.ends).max(0.0)
            }
            FromSpec::Inside(_) | FromSpec::Spread(_) => 0.0,
        }
    }

    /// How much the step with this name is expected to grow; of a plan only its ends are known before.
    fn expected(&mut self, name: &str) -> Expected {
        if let Some(&known) = self.expected.get(name) {
            return known;
        }
        // Nothing is expected of steps that wait for each other.
        self.expected.insert(name.to_owned(), Expected::default());
        let scene = self.scene;
        let Some(step) = scene.grow.get(name) else { return Expected::default() };
        let one = match &step.by {
            MethodSpec::Segments(spec) => {
                let starts = self.starts(step);
                spec.expected(starts)
            }
            _ => {
                let ends = |set: &EndpointSpec| {
                    let at = set.at.as_ref().map_or(0, Vec::len) as f64;
                    set.count.as_ref().and_then(crate::math::PerRound::once).unwrap_or(at)
                };
                Expected { ends: step.to.values().map(ends).sum(), ..Expected::default() }
            }
        };
        let parts = step.symmetry.map_or(1.0, |symmetry| f64::from(symmetry.parts()));
        let all = Expected { nodes: one.nodes * parts, ends: one.ends * parts };
        self.expected.insert(name.to_owned(), all);
        all
    }
}

fn attractor(spec: &AttractorSpec) -> Attractor {
    Attractor { at: spec.at.0, strength: spec.strength }
}
