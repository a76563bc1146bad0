//! Shapes: regions of the plane or of space as signed distance functions.

use std::sync::Arc;

use super::{Bounds, ClosedMesh, Outline, Profile, Sampled, SignedDistance, Voxels, segment_distance};
use crate::math::{DMat3, DVec2, DVec3};

/// A solid or a combination of shapes, with names and files resolved.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// An axis-aligned box.
    Box {
        /// The corner with the lowest coordinates.
        min: DVec3,
        /// The corner with the highest coordinates.
        max: DVec3,
    },
    /// A ball; in the plane, a disc.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// An axis-aligned ellipsoid.
    Ellipsoid {
        /// Its centre.
        centre: DVec3,
        /// Its half-axes.
        radii: DVec3,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Centre of one end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// A cylinder with hemispherical ends.
    Capsule {
        /// Centre of one hemisphere.
        from: DVec3,
        /// Centre of the other hemisphere.
        to: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// A spherical sector: the part of a ball within an angle of a direction.
    Sector {
        /// The ball's centre.
        at: DVec3,
        /// The direction, a unit vector.
        along: DVec3,
        /// The angle, in radians, below pi.
        angle: f64,
        /// Sine and cosine of the angle.
        side: DVec2,
        /// The ball's radius.
        radius: f64,
    },
    /// A solid of revolution.
    Revolved {
        /// The point of the axis at height 0.
        from: DVec3,
        /// The axis' direction, a unit vector.
        along: DVec3,
        /// The profile.
        profile: Arc<Profile>,
    },
    /// The inside of a mesh.
    Mesh(Arc<ClosedMesh>),
    /// The region of outlines: in the plane, or upright in space and extruded along y.
    Outlined {
        /// The outlines.
        outline: Arc<Outline>,
        /// Extent along y, centred at 0; `None` in the plane.
        depth: Option<f64>,
    },
    /// The points near the surface of a shape.
    Shell {
        /// The shape.
        of: Shape,
        /// Thickness outside the surface.
        outside: f64,
        /// Thickness inside the surface.
        inside: f64,
    },
    /// Placeholder of what the step with this index grows within these bounds; empty until [`Shape::with_grown`].
    Grown(usize, Bounds),
    /// A grown solid.
    Voxels(Arc<Voxels>),
    /// A shape with cached samples ([`Shape::sampled`]).
    Sampled(Arc<Sampled<Shape>>),
    /// A shape scaled, then rotated, then translated.
    Placed {
        /// The shape.
        shape: Shape,
        /// Scale factor.
        scale: f64,
        /// Rotation.
        turn: DMat3,
        /// Translation.
        by: DVec3,
    },
    /// The union of shapes.
    Union(Vec<Shape>),
    /// The intersection of shapes.
    Intersection(Vec<Shape>),
    /// The first shape less all others.
    Difference(Vec<Shape>),
}

/// A shape with names and files resolved; clones share it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape(Arc<Solid>);

impl SignedDistance for Shape {
    fn distance(&self, p: DVec3) -> f64 {
        Self::distance(self, p)
    }
}

impl Shape {
    /// A shape of one solid, whose lengths are above 0 and whose directions are unit vectors.
    #[must_use]
    pub fn new(solid: Solid) -> Self {
        Self(Arc::new(solid))
    }

    /// A cone with flat ends of these radii; `None` where its length or both radii are 0.
    #[must_use]
    pub fn cone(from: DVec3, to: DVec3, [a, b]: [f64; 2]) -> Option<Self> {
        let along = (to - from).try_normalize()?;
        let outline = vec![DVec2::new(a, 0.0), DVec2::new(b, (to - from).length())];
        let profile = Arc::new(Profile::new(outline).ok()?);
        Some(Self::new(Solid::Revolved { from, along, profile }))
    }

    /// The shape scaled about the origin, rotated by `turn` and translated by `by`.
    #[must_use]
    pub fn placed(&self, scale: f64, turn: DMat3, by: DVec3) -> Self {
        let point = |p: DVec3| turn * (p * scale) + by;
        // Solids that stay of their kind keep tight bounding boxes.
        Self::new(match &*self.0 {
            Solid::Sphere { centre, radius } => Solid::Sphere { centre: point(*centre), radius: radius * scale },
            Solid::Sector { at, along, angle, side, radius } => {
                let (at, along) = (point(*at), turn * *along);
                Solid::Sector { at, along, angle: *angle, side: *side, radius: radius * scale }
            }
            Solid::Cylinder { from, to, radius } => {
                Solid::Cylinder { from: point(*from), to: point(*to), radius: radius * scale }
            }
            Solid::Capsule { from, to, radius } => {
                Solid::Capsule { from: point(*from), to: point(*to), radius: radius * scale }
            }
            _ => Solid::Placed { shape: self.clone(), scale, turn, by },
        })
    }

    /// Is `p` inside or on the surface?
    #[must_use]
    pub fn contains(&self, p: DVec3) -> bool {
        self.distance(p) <= 0.0
    }

    /// Signed distance of `p` from the surface, negative inside. Exact for single solids, of first order for the ellipsoid,
    /// a lower bound for combinations.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.signed(p, &|centre, radii, p| {
            // Quilez, "ellipsoid SDF": the implicit function over its gradient's length.
            let p = p - centre;
            let (k0, k1) = ((p / radii).length(), (p / (radii * radii)).length());
            if k1 == 0.0 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
        })
    }

    /// A conservative distance bound: it has the sign of [`Shape::distance`], and its magnitude never exceeds the true
    /// distance from the surface.
    #[must_use]
    pub fn margin(&self, p: DVec3) -> f64 {
        if self.is_sampled() {
            // Distances of grids and shells are off by less than half.
            return self.distance(p) * 0.5;
        }
        // |p / radii| has the Lipschitz constant 1 / (the least radius).
        self.signed(p, &|centre, radii, p| (((p - centre) / radii).length() - 1.0) * radii.min_element())
    }

    /// The signed distance function with `ellipsoid`'s for ellipsoids, called with centre, half-axes and point.
    fn signed(&self, p: DVec3, ellipsoid: &dyn Fn(DVec3, DVec3, DVec3) -> f64) -> f64 {
        match &*self.0 {
            Solid::Box { min, max } => {
                let half = (*max - *min) * 0.5;
                let q = (p - (*min + *max) * 0.5).abs() - half;
                // A flat box has an interior in its own plane.
                let inner = if half.z == 0.0 && q.z <= 0.0 { q.x.max(q.y) } else { q.max_element() };
                q.max(DVec3::ZERO).length() + inner.min(0.0)
            }
            Solid::Sphere { centre, radius } => (p - *centre).length() - radius,
            Solid::Ellipsoid { centre, radii } => ellipsoid(*centre, *radii, p),
            Solid::Cylinder { from, to, radius } => {
                let (axis, p) = (*to - *from, p - *from);
                let length = axis.length();
                let along = p.dot(axis) / length;
                let out = libm::sqrt((p.length_squared() - along * along).max(0.0)) - radius;
                let past = (along - length * 0.5).abs() - length * 0.5;
                let corner = libm::sqrt(out.max(0.0) * out.max(0.0) + past.max(0.0) * past.max(0.0));
                corner + out.max(past).min(0.0)
            }
            Solid::Capsule { from, to, radius } => segment_distance(p, *from, *to) - radius,
            Solid::Sector { at, along, side, radius, .. } => {
                let q = beside(p - *at, *along);
                let side = *side;
                // Signed distance from the conical side, a segment in the half-plane of the axis; negative within the angle.
                let foot = side * q.dot(side).clamp(0.0, *radius);
                let flank = (q - foot).length();
                let flank = if q.x * side.y > q.y * side.x { flank } else { -flank };
                flank.max(q.length() - radius)
            }
            Solid::Revolved { from, along, profile } => profile.distance(beside(p - *from, *along)),
            Solid::Mesh(mesh) => mesh.distance(p),
            Solid::Outlined { outline, depth: None } => outline.distance(p.truncate()),
            Solid::Outlined { outline, depth: Some(depth) } => {
                let (across, along) = (outline.distance(DVec2::new(p.x, p.z)), p.y.abs() - depth * 0.5);
                let corner = DVec2::new(across, along).max(DVec2::ZERO).length();
                corner + across.max(along).min(0.0)
            }
            Solid::Shell { of, outside, inside } => {
                let d = of.distance(p);
                (d - outside).max(-d - inside)
            }
            Solid::Grown(..) => f64::INFINITY,
            Solid::Voxels(voxels) => voxels.distance(p),
            Solid::Sampled(sampled) => sampled.distance(p),
            Solid::Placed { shape, scale, turn, by } => {
                shape.signed(turn.transpose() * (p - *by) / *scale, ellipsoid) * scale
            }
            Solid::Union(of) => of.iter().map(|s| s.signed(p, ellipsoid)).fold(f64::INFINITY, f64::min),
            Solid::Intersection(of) => of.iter().map(|s| s.signed(p, ellipsoid)).fold(f64::NEG_INFINITY, f64::max),
            Solid::Difference(of) => {
                let less = of[1..].iter().map(|s| -s.signed(p, ellipsoid));
                less.fold(of[0].signed(p, ellipsoid), f64::max)
            }
        }
    }

    /// The shape with every [`Solid::Grown`] replaced by the voxels that `grown` has for its step.
    #[must_use]
    pub fn with_grown(&self, grown: &dyn Fn(usize) -> Option<Arc<Voxels>>) -> Self {
        let all = |of: &[Self]| of.iter().map(|shape| shape.with_grown(grown)).collect();
        match &*self.0 {
            Solid::Grown(step, _) => grown(*step).map_or_else(|| self.clone(), |v| Self::new(Solid::Voxels(v))),
            Solid::Shell { of, outside, inside } => {
                Self::new(Solid::Shell { of: of.with_grown(grown), outside: *outside, inside: *inside })
            }
            Solid::Sampled(sampled) => sampled.shape().with_grown(grown).sampled(sampled.spacing()),
            Solid::Placed { shape, scale, turn, by } => {
                Self::new(Solid::Placed { shape: shape.with_grown(grown), scale: *scale, turn: *turn, by: *by })
            }
            Solid::Union(of) => Self::new(Solid::Union(all(of))),
            Solid::Intersection(of) => Self::new(Solid::Intersection(all(of))),
            Solid::Difference(of) => Self::new(Solid::Difference(all(of))),
            _ => self.clone(),
        }
    }

    /// The shape with cached samples on a grid with this spacing if it contains meshes, whose distances are costly.
    #[must_use]
    pub fn sampled(&self, spacing: f64) -> Self {
        if self.has_mesh() {
            Self::new(Solid::Sampled(Arc::new(Sampled::new(self.clone(), spacing))))
        } else {
            self.clone()
        }
    }

    /// The inverse of [`Shape::sampled`].
    #[must_use]
    pub fn unsampled(&self) -> Self {
        if let Solid::Sampled(sampled) = &*self.0 { sampled.shape().clone() } else { self.clone() }
    }

    fn has_mesh(&self) -> bool {
        match &*self.0 {
            Solid::Mesh(_) => true,
            Solid::Placed { shape, .. } | Solid::Shell { of: shape, .. } => shape.has_mesh(),
            Solid::Union(of) | Solid::Intersection(of) | Solid::Difference(of) => of.iter().any(Self::has_mesh),
            _ => false,
        }
    }

    /// Does it contain an outline, extruded (`is_deep`) or flat?
    #[must_use]
    pub fn has_outline(&self, is_deep: bool) -> bool {
        match &*self.0 {
            Solid::Outlined { depth, .. } => depth.is_some() == is_deep,
            Solid::Placed { shape, .. } | Solid::Shell { of: shape, .. } => shape.has_outline(is_deep),
            Solid::Union(of) | Solid::Intersection(of) | Solid::Difference(of) => {
                of.iter().any(|shape| shape.has_outline(is_deep))
            }
            _ => false,
        }
    }

    /// Does it contain a solid whose distances are approximate on both sides of its surface?
    fn is_sampled(&self) -> bool {
        match &*self.0 {
            Solid::Voxels(_) | Solid::Sampled(_) | Solid::Shell { .. } => true,
            Solid::Placed { shape, .. } => shape.is_sampled(),
            Solid::Union(of) | Solid::Intersection(of) | Solid::Difference(of) => of.iter().any(Self::is_sampled),
            _ => false,
        }
    }

    /// Depth of `p` below the outer surface: for a sector, below its spherical part.
    #[must_use]
    pub fn depth(&self, p: DVec3) -> f64 {
        match &*self.0 {
            Solid::Sector { at, radius, .. } => radius - (p - *at).length(),
            Solid::Placed { shape, scale, turn, by } => shape.depth(turn.transpose() * (p - *by) / *scale) * scale,
            _ => -self.distance(p),
        }
    }

    /// A bounding box.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let both = |a: DVec3, b: DVec3, r: f64| Bounds::of_ball(a, r).union(Bounds::of_ball(b, r));
        match &*self.0 {
            Solid::Box { min, max } => Bounds { min: *min, max: *max },
            Solid::Sphere { centre, radius } => Bounds::of_ball(*centre, *radius),
            Solid::Ellipsoid { centre, radii } => Bounds { min: *centre - *radii, max: *centre + *radii },
            Solid::Cylinder { from, to, radius } | Solid::Capsule { from, to, radius } => both(*from, *to, *radius),
            Solid::Sector { at, along, angle, radius, .. } => sector_bounds(*along, *angle, *radius).moved(*at),
            Solid::Revolved { from, along, profile } => {
                let (across, low, high) = profile.extent();
                // Half-extent of a disc of radius `across` at right angles to the axis.
                let disc = (DVec3::ONE - *along * *along).max(DVec3::ZERO).map(libm::sqrt) * across;
                let end = |height: f64| {
                    let at = *from + *along * height;
                    Bounds { min: at - disc, max: at + disc }
                };
                end(low).union(end(high))
            }
            Solid::Mesh(mesh) => mesh.bounds(),
            Solid::Outlined { outline, depth: None } => outline.bounds(),
            Solid::Outlined { outline, depth: Some(depth) } => {
                let upright = |p: DVec3, y: f64| DVec3::new(p.x, y, p.y);
                let bounds = outline.bounds();
                Bounds { min: upright(bounds.min, -depth * 0.5), max: upright(bounds.max, depth * 0.5) }
            }
            Solid::Shell { of, outside, .. } => {
                let bounds = of.bounds();
                Bounds { min: bounds.min - *outside, max: bounds.max + *outside }
            }
            Solid::Grown(_, bounds) => *bounds,
            Solid::Voxels(voxels) => voxels.bounds(),
            Solid::Sampled(sampled) => sampled.shape().bounds(),
            Solid::Placed { shape, scale, turn, by } => {
                Bounds::of_points(shape.bounds().corners().map(|p| *turn * (p * *scale) + *by))
            }
            Solid::Union(of) => of.iter().map(Self::bounds).fold(Bounds::EMPTY, Bounds::union),
            Solid::Intersection(of) => of[1..]
                .iter()
                .map(Self::bounds)
                .fold(of[0].bounds(), |a, b| Bounds { min: a.min.max(b.min), max: a.max.min(b.max) }),
            Solid::Difference(of) => of[0].bounds(),
        }
    }

    /// Is it an axis-aligned box?
    #[must_use]
    pub fn is_box(&self) -> bool {
        matches!(*self.0, Solid::Box { .. })
    }

    /// Its solid.
    #[must_use]
    pub fn solid(&self) -> &Solid {
        &self.0
    }
}

/// The bounding box of a sector with its apex at the origin: along an axis within the angle it extends to the sphere,
/// otherwise to the rim.
fn sector_bounds(along: DVec3, angle: f64, radius: f64) -> Bounds {
    let reach = |cos: f64| {
        let own = libm::acos(cos.clamp(-1.0, 1.0));
        if own <= angle { radius } else { (radius * libm::cos(own - angle)).max(0.0) }
    };
    let high = along.map(reach);
    let low = along.map(|cos| -reach(-cos));
    Bounds { min: low, max: high }
}

/// Cylindrical coordinates of `p` about the axis `along` through the origin: distance from it, and height.
fn beside(p: DVec3, along: DVec3) -> DVec2 {
    let height = p.dot(along);
    DVec2::new((p - along * height).length(), height)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::super::shape_spec::{MeshParts, Rings, ShapeFiles, ShapeSpec, SketchLines};
    use super::*;
    use crate::geom::ShapeError;

    struct NoFiles;

    impl ShapeFiles for NoFiles {
        fn letters(&self, _: &str, _: Option<&str>) -> Result<Rings, ShapeError> {
            Err(ShapeError::file("none", "no files here"))
        }

        fn picture_outlines(&self, _: &str, _: f64, _: bool) -> Result<Rings, ShapeError> {
            Err(ShapeError::file("none", "no files here"))
        }

        fn sketch_lines(&self, _: &str) -> Result<SketchLines, ShapeError> {
            Err(ShapeError::file("none", "no files here"))
        }

        fn mesh_parts(&self, _: &str) -> Result<MeshParts, ShapeError> {
            Err(ShapeError::file("none", "no files here"))
        }
    }

    fn shape(toml: &str) -> Result<Shape, String> {
        let spec: BTreeMap<String, ShapeSpec> = toml::from_str(toml).map_err(|e| e.to_string())?;
        Ok(spec["s"].resolve(&spec, &NoFiles)?)
    }

    #[test]
    fn distances_are_signed() {
        let p = DVec3::new(3.0, 0.0, 0.0);
        for (toml, expected) in [
            ("s.box = { min = [-1, -1, -1], max = [1, 1, 1] }", 2.0),
            ("s.sphere = { centre = [0, 0, 0], radius = 1 }", 2.0),
            ("s.ellipsoid = { centre = [0, 0, 0], radii = [1, 1, 1] }", 2.0),
            ("s.cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 1 }", 2.0),
            ("s.capsule = { from = [0, 0, 0], to = [4, 0, 0], radius = 1 }", -1.0),
            ("s.cone = { from = [0, 0, -1], to = [0, 0, 1], radii = [1, 1] }", 2.0),
            ("s.cone = { from = [4, 0, 0], to = [0, 0, 0], radii = [4, 0] }", -1.0),
            ("s.sector = { at = [1, 0, 0], toward = [1, 0, 0], angle = 90, radius = 4 }", -2.0),
            ("s.sector = { at = [4, 0, 0], toward = [1, 0, 0], angle = 90, radius = 4 }", 1.0),
            ("s.sector = { angle = 45, radius = 1 }", (10.0 - 3.0 * std::f64::consts::SQRT_2).sqrt()),
            (
                "s.placed = { shape = { sphere = { centre = [0, 0, 1], radius = 1 } }, turn = 90, scale = 2, by = [0, 0, 0] }",
                -1.0,
            ),
            (
                "s.union = [\"t\", { sphere = { centre = [3, 0, 0], radius = 2 } }]\nt.sphere = { centre = [0, 0, 0], radius = 1 }",
                -2.0,
            ),
            (
                "s.difference = [{ sphere = { centre = [3, 0, 0], radius = 2 } }, { sphere = { centre = [3, 0, 0], radius = 1 } }]",
                1.0,
            ),
        ] {
            let shape = shape(toml).unwrap();
            assert!((shape.distance(p) - expected).abs() < 1e-9, "{toml}: {}", shape.distance(p));
            assert_eq!(shape.contains(p), expected <= 0.0);
        }
    }

    proptest! {
        /// Interior points lie in the bounding box, and no ball of the margin's size crosses the surface.
        #[test]
        fn margins_and_bounds_hold(
            which in 0..7_usize, p in prop::array::uniform3(-3.0..3.0), way in prop::array::uniform3(-1.0..1.0), share in 0.0..0.999
        ) {
            let shape = shape([
                "s.ellipsoid = { centre = [0.2, 0, 0], radii = [2, 0.5, 1] }",
                "s.cone = { from = [0, 0.3, -1], to = [1, 0, 1], radii = [1.5, 0.3] }",
                "s.sector = { at = [0, 0, -1], toward = [0.3, 0.2, 1], angle = 40, radius = 2 }",
                "s.sector = { toward = [-1, 0.2, 0.3], angle = 130, radius = 1.5 }",
                "s.placed = { shape = { ellipsoid = { centre = [0, 0, 1], radii = [1, 1, 2] } }, turn = 40, about = [1, 1, 0], by = [0.5, 0, 0] }",
                "s.difference = [{ sphere = { centre = [0, 0, 0], radius = 2 } }, { sector = { angle = 60, radius = 3 } }]",
                "s.union = [{ cylinder = { from = [0, 0, -2], to = [0, 0, 0], radius = 0.4 } }, { sector = { angle = 90, radius = 2 } }]",
            ][which]).unwrap();
            let p = DVec3::from_array(p);
            let margin = shape.margin(p);
            prop_assert_eq!(margin <= 0.0, shape.contains(p));
            let bounds = shape.bounds();
            prop_assert!(margin > 0.0 || bounds.distance(p) < 1e-9, "{} is inside, but off the box {:?}", p, bounds);
            let near = p + DVec3::from_array(way).normalize_or(DVec3::X) * (margin.abs() * share);
            prop_assert_eq!(shape.contains(near), margin <= 0.0, "{} {} {}", p, near, margin);
        }
    }

    #[test]
    fn mistakes_are_named() {
        assert!(shape("s.union = [\"s\"]").unwrap_err().contains("made of itself"));
        assert!(shape("s.union = [\"crwon\"]\ncrown.union = []").unwrap_err().contains("did you mean `crown`"));
        assert!(shape("s.box = { min = [1, 0], max = [0, 0] }").unwrap_err().contains("min below max"));
        assert!(shape("s.cone = { from = [1, 0, 0], to = [0, 0, 0], radii = [0, 0] }").unwrap_err().contains("radius"));
    }
}
