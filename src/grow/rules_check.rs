//! Keys of a step are checked against what goes with its method.

use super::lookup::Lookup;
use super::rules::{Needs, Rules};
use super::space::Space;
use super::spec::StepSpec;

impl Rules {
    /// Tells of a space where there can be none, and of one that is missing.
    pub fn check_given(&self, step: &StepSpec, lookup: &mut dyn Lookup) {
        let is_free = self.needs == Needs::Nothing;
        if is_free && step.space.is_some() {
            lookup.wrong("space", format!("{} no space: it stays `inside` a shape", self.subject));
        } else if !is_free && step.space.is_none() {
            lookup.wrong("space", "this way of growing needs a `space`".to_owned());
        }
    }

    /// Tells of all keys of `step` that do not go with it, and of those that are missing.
    pub fn check(&self, step: &StepSpec, space: Option<&Space>, lookup: &mut dyn Lookup) {
        self.check_space(space, lookup);
        let given = [
            ("repeat", step.repeat.is_some(), self.repeats),
            ("along", step.along > 0.0, self.repeats),
            ("to", !step.to.is_empty(), self.has_endpoints),
            ("refine", step.refine.is_some(), self.has_endpoints),
            ("width", step.width.is_some(), self.has_limbs),
            ("smooth", step.smooth > 0.0, self.has_limbs),
            ("strands", step.strands.is_some(), self.has_limbs),
            ("symmetry", step.symmetry.is_some(), self.has_limbs),
            ("form", step.form.is_some(), self.has_limbs),
        ];
        for (key, ..) in given.into_iter().filter(|(_, is_given, is_allowed)| *is_given && !is_allowed) {
            let own = if key == "smooth" { " a `smooth` of their own, and" } else { "" };
            lookup.wrong(key, format!("{}{own} no `{key}`", self.subject));
        }
        if step.toward.is_some() && !self.has_attractor {
            lookup.wrong("toward", "an attractor is for growth by segments and by voxels".to_owned());
        }
        if self.has_endpoints && step.to.is_empty() {
            lookup.wrong("to", "a step needs at least one set of endpoints, `to.NAME`".to_owned());
        }
        if self.has_limbs && step.width.is_none() {
            lookup.wrong("width", "limbs need a `width`".to_owned());
        }
    }

    fn check_space(&self, space: Option<&Space>, lookup: &mut dyn Lookup) {
        match (self.needs, space) {
            (_, None)
            | (Needs::Nothing, _)
            | (Needs::Voxels, Some(Space::Voxels(_)))
            | (Needs::Lattice, Some(Space::Lattice(_))) => {}
            (Needs::Voxels, Some(_)) => {
                lookup.wrong("space", "growth by voxels needs a space with `nodes.voxels`".to_owned());
            }
            (_, Some(Space::Voxels(_))) => {
                lookup.wrong("space", "in voxels there is nothing but growth `by.voxels`".to_owned());
            }
            (Needs::Lattice, Some(_)) => {
                lookup.wrong(
                    "by",
                    "only paths are planned among scattered nodes: this needs a lattice (`nodes.lattice`)".to_owned(),
                );
            }
            (Needs::Graph, Some(_)) => {}
        }
        let nodes = space.and_then(Space::lattice).map_or(0, |space| space.window.nodes());
        if nodes > self.most_nodes {
            let most = self.most_nodes;
            let message = format!("this way of growing takes {most} nodes at most, not {nodes}: use a wider spacing");
            lookup.wrong("space", message);
        }
    }
}
