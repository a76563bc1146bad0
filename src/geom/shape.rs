//! Shapes: regions of the plane or of space, made of a few solids.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::math::{DVec3, Point, Ref, unknown};

/// A solid, or several combined; `S` is what the combinations are made of.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Solid<S> {
    /// All between two corners.
    Box {
        /// The corner with the lowest coordinates.
        min: Point,
        /// The corner with the highest coordinates.
        max: Point,
    },
    /// A ball; in the plane, a disc.
    Sphere {
        /// Its middle.
        centre: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// An ellipsoid along the axes; in the plane, an ellipse.
    Ellipsoid {
        /// Its middle.
        centre: Point,
        /// Its half-axes.
        radii: Point,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Middle of one end.
        from: Point,
        /// Middle of the other end.
        to: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// A cylinder with round ends.
    Capsule {
        /// Middle of one end's ball.
        from: Point,
        /// Middle of the other end's ball.
        to: Point,
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
        radius: f64,
    },
    /// All that is in at least one of these.
    Union(Vec<S>),
    /// All that is in every one of these.
    Intersection(Vec<S>),
    /// All that is in the first and in no other.
    Difference(Vec<S>),
}

/// A shape as a scene writes it: a solid, or the name of one under `[shape]`.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeSpec {
    /// The name of a shape.
    Named(Ref<Shape>),
    /// A shape in place.
    Inline(Box<Solid<ShapeSpec>>),
}

impl<'de> Deserialize<'de> for ShapeSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match serde_json::Value::deserialize(deserializer)? {
            serde_json::Value::String(name) => Ok(Self::Named(Ref::new(name))),
            value => Solid::deserialize(value).map(|solid| Self::Inline(Box::new(solid))).map_err(D::Error::custom),
        }
    }
}

impl JsonSchema for ShapeSpec {
    fn schema_name() -> Cow<'static, str> {
        "Shape".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let solid = generator.subschema_for::<Solid<Self>>();
        json_schema!({
            "description": "A shape, or the name of one under `[shape]`.",
            "anyOf": [{ "type": "string" }, solid]
        })
    }
}

/// A shape whose names are resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape(Arc<Solid<Shape>>);

/// A box around something, along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the lowest coordinates.
    pub min: DVec3,
    /// The corner with the highest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The bounds of nothing: any union with it is the other.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The least box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box around a ball.
    #[must_use]
    pub fn of_ball(centre: DVec3, radius: f64) -> Self {
        Self { min: centre - radius, max: centre + radius }
    }

    /// Extent along each axis.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The middle.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, axis: usize| if i & bit == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(1, 0), pick(2, 1), pick(4, 2))
        })
    }

    /// Does it hold nothing?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }
}

impl ShapeSpec {
    /// A box.
    #[must_use]
    pub fn of_box(bounds: Bounds) -> Self {
        Self::Inline(Box::new(Solid::Box { min: Point(bounds.min), max: Point(bounds.max) }))
    }

    /// The shape, its names looked up in `named`.
    ///
    /// # Errors
    /// One sentence a mistake: names that lead nowhere or in a circle, sizes that are not positive.
    pub fn resolve(&self, named: &BTreeMap<String, ShapeSpec>) -> Result<Shape, String> {
        self.resolve_within(named, &mut Vec::new())
    }

    fn resolve_within(&self, named: &BTreeMap<String, ShapeSpec>, within: &mut Vec<String>) -> Result<Shape, String> {
        let solid = match self {
            Self::Inline(solid) => solid,
            Self::Named(Ref { name, .. }) => {
                if within.contains(name) {
                    return Err(format!("shape `{name}` is made of itself"));
                }
                let spec = named.get(name).ok_or_else(|| unknown("shape", name, named.keys()))?;
                within.push(name.clone());
                let shape = spec.resolve_within(named, within);
                within.pop();
                return shape;
            }
        };
        let mut all = |specs: &[Self]| {
            if specs.is_empty() {
                return Err("combine at least one shape".to_owned());
            }
            specs.iter().map(|spec| spec.resolve_within(named, within)).collect()
        };
        Ok(Shape(Arc::new(match &**solid {
            Solid::Union(of) => Solid::Union(all(of)?),
            Solid::Intersection(of) => Solid::Intersection(all(of)?),
            Solid::Difference(of) => Solid::Difference(all(of)?),
            Solid::Box { min, max } => {
                if !min.0.cmple(max.0).all() {
                    return Err(format!("a box needs min below max, not {} and {}", min.0, max.0));
                }
                Solid::Box { min: *min, max: *max }
            }
            Solid::Ellipsoid { centre, radii } => {
                // In the plane the third half-axis is not given, and does not matter.
                let mut r = radii.0;
                if r.z == 0.0 {
                    r.z = 1.0;
                }
                if !r.cmpgt(DVec3::ZERO).all() {
                    return Err(format!("an ellipsoid needs half-axes above 0, not {}", radii.0));
                }
                Solid::Ellipsoid { centre: *centre, radii: Point(r) }
            }
            &Solid::Sphere { centre, radius } => Solid::Sphere { centre, radius },
            &Solid::Cylinder { from, to, radius } if from != to => Solid::Cylinder { from, to, radius },
            &Solid::Cylinder { .. } => return Err("a cylinder needs two different ends".to_owned()),
            &Solid::Capsule { from, to, radius } => Solid::Capsule { from, to, radius },
        })))
    }
}

impl Shape {
    /// Is `p` inside or on the surface?
    #[must_use]
    pub fn contains(&self, p: DVec3) -> bool {
        self.distance(p) <= 0.0
    }

    /// Signed distance from the surface, negative inside. Exact for single solids except the ellipsoid, whose distance
    /// is of first order; for combinations a lower bound.
    #[must_use]
    pub fn distance(&self, p: DVec3) -> f64 {
        match &*self.0 {
            Solid::Box { min, max } => {
                let half = (max.0 - min.0) * 0.5;
                let q = (p - (min.0 + max.0) * 0.5).abs() - half;
                // A flat box has an inside in its own plane.
                let inner = if half.z == 0.0 && q.z <= 0.0 { q.x.max(q.y) } else { q.max_element() };
                q.max(DVec3::ZERO).length() + inner.min(0.0)
            }
            Solid::Sphere { centre, radius } => (p - centre.0).length() - radius,
            Solid::Ellipsoid { centre, radii } => {
                let p = p - centre.0;
                let (k0, k1) = ((p / radii.0).length(), (p / (radii.0 * radii.0)).length());
                if k1 == 0.0 { -radii.0.min_element() } else { k0 * (k0 - 1.0) / k1 }
            }
            Solid::Cylinder { from, to, radius } => {
                let (axis, p) = (to.0 - from.0, p - from.0);
                let length = axis.length();
                let along = p.dot(axis) / length;
                let out = libm::sqrt((p.length_squared() - along * along).max(0.0)) - radius;
                let past = (along - length * 0.5).abs() - length * 0.5;
                let corner = libm::sqrt(out.max(0.0) * out.max(0.0) + past.max(0.0) * past.max(0.0));
                corner + out.max(past).min(0.0)
            }
            Solid::Capsule { from, to, radius } => segment_distance(p, from.0, to.0) - radius,
            Solid::Union(of) => of.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min),
            Solid::Intersection(of) => of.iter().map(|s| s.distance(p)).fold(f64::NEG_INFINITY, f64::max),
            Solid::Difference(of) => {
                let less = of[1..].iter().map(|s| -s.distance(p));
                less.fold(of[0].distance(p), f64::max)
            }
        }
    }

    /// A box that holds the shape.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let both = |a: DVec3, b: DVec3, r: f64| Bounds::of_ball(a, r).union(Bounds::of_ball(b, r));
        match &*self.0 {
            Solid::Box { min, max } => Bounds { min: min.0, max: max.0 },
            Solid::Sphere { centre, radius } => Bounds::of_ball(centre.0, *radius),
            Solid::Ellipsoid { centre, radii } => Bounds { min: centre.0 - radii.0, max: centre.0 + radii.0 },
            Solid::Cylinder { from, to, radius } | Solid::Capsule { from, to, radius } => both(from.0, to.0, *radius),
            Solid::Union(of) => of.iter().map(Self::bounds).fold(Bounds::EMPTY, Bounds::union),
            Solid::Intersection(of) => of[1..]
                .iter()
                .map(Self::bounds)
                .fold(of[0].bounds(), |a, b| Bounds { min: a.min.max(b.min), max: a.max.min(b.max) }),
            Solid::Difference(of) => of[0].bounds(),
        }
    }

    /// Is it nothing but a box along the axes?
    #[must_use]
    pub fn is_box(&self) -> bool {
        matches!(*self.0, Solid::Box { .. })
    }

    /// The solid that it is.
    #[must_use]
    pub fn solid(&self) -> &Solid<Self> {
        &self.0
    }
}

/// Distance of `p` from the segment from `a` to `b`.
pub(super) fn segment_distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (p, axis) = (p - a, b - a);
    let length = axis.length_squared();
    let t = if length > 0.0 { (p.dot(axis) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p - axis * t).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(toml: &str) -> Result<Shape, String> {
        let spec: BTreeMap<String, ShapeSpec> = toml::from_str(toml).map_err(|e| e.to_string())?;
        spec["s"].resolve(&spec)
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
            assert!((shape.distance(p) - expected).abs() < 1e-12, "{toml}: {}", shape.distance(p));
            assert_eq!(shape.contains(p), expected <= 0.0);
        }
    }

    #[test]
    fn mistakes_are_named() {
        assert!(shape("s.union = [\"s\"]").unwrap_err().contains("made of itself"));
        assert!(shape("s.union = [\"crwon\"]\ncrown.union = []").unwrap_err().contains("did you mean `crown`"));
        assert!(shape("s.box = { min = [1, 0], max = [0, 0] }").unwrap_err().contains("min below max"));
    }
}
