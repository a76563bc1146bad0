//! A space of scattered nodes: as it is, or around the end of a limb.

use crate::geom::{Shape, Solid};
use crate::graph::{
    CostField, Joining, Region, Scatter, ScatterError, ScatterPlan, WeightTable, Weights, poisson_points, scatter_bytes,
    scatter_estimate,
};
use crate::math::{DMat3, DVec3, Stream};

/// Scattered nodes in a shape, whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct ScatterSpace {
    /// Where nodes are.
    pub shape: Shape,
    /// Where none are, in the scene's own coordinates.
    pub forbid: Option<Shape>,
    /// Least distance between nodes.
    pub spacing: f64,
    /// Do they lie in the plane?
    pub is_plane: bool,
    /// Which nodes are joined.
    pub joining: Joining,
    /// Volumes in addition to the shape.
    pub clusters: Option<Clusters>,
    /// The random part of the weights.
    pub weights: Weights,
    /// The rest of them.
    pub fields: Vec<CostField>,
    /// Name of the random stream.
    pub stream: String,
}

/// Volumes around a few points (2012, section 3.3.1).
#[derive(Clone, Debug)]
pub struct Clusters {
    /// The coarse shape in which the points lie.
    pub inside: Shape,
    /// Least distance between the points.
    pub apart: f64,
    /// Radius of the spheres.
    pub radius: f64,
    /// Where the cones end.
    pub foot: DVec3,
    /// Radius of the cones there.
    pub neck: f64,
}

/// Clusters are counted in a byte.
pub const MOST_CLUSTERS: usize = 64;

/// Where a space is used: scaled, turned and moved; its random numbers are of its own.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Where its origin is.
    pub at: DVec3,
    /// A rotation.
    pub turn: DMat3,
    /// Its size over the one that is written.
    pub size: f64,
}

/// A shape without what is forbidden in it, and the places that its box must hold.
struct Open<'a> {
    shape: &'a Shape,
    forbid: Option<&'a Shape>,
    fixed: &'a [DVec3],
}

impl Region for Open<'_> {
    fn margin(&self, p: DVec3) -> f64 {
        let own = self.shape.margin(p);
        self.forbid.map_or(own, |forbid| own.max(-forbid.margin(p)))
    }

    fn bounds(&self) -> [DVec3; 2] {
        let own = self.shape.bounds();
        self.fixed.iter().fold([own.min, own.max], |[low, high], &p| [low.min(p), high.max(p)])
    }
}

/// A graph, and the volumes that it was scattered in beside the space's shape.
pub(super) struct Scattered {
    pub graph: Scatter,
    /// The spheres of its clusters; owner i has the sphere i - 1.
    pub spheres: Vec<Shape>,
    /// The cluster volumes, for drawings.
    pub volumes: Vec<Shape>,
}

impl ScatterSpace {
    /// Index of the coordinate that points up: y in the plane, z in space.
    #[must_use]
    pub fn up(&self) -> usize {
        if self.is_plane { 1 } else { 2 }
    }

    /// About how many nodes it has.
    #[must_use]
    pub fn estimate(&self) -> f64 {
        let clusters = self.clusters.as_ref().map(|c| c.inside.bounds().grown(c.radius));
        let bounds = clusters.map_or(self.shape.bounds(), |b| b.union(self.shape.bounds()));
        scatter_estimate([bounds.min, bounds.max], self.spacing, self.is_plane)
    }

    /// Bytes that planning in it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        scatter_bytes(self.estimate())
    }

    /// The table of its weights.
    ///
    /// # Errors
    /// Where they are out of range.
    pub fn table(&self) -> Result<WeightTable, ScatterError> {
        Ok(WeightTable::new(self.weights, 1.0, 0.0)?)
    }

    /// The graph of a scene with this seed, with nodes at `fixed` as far as these are apart.
    ///
    /// # Errors
    /// [`ScatterError`].
    pub(super) fn scatter(&self, seed: u64, fixed: &[DVec3]) -> Result<Scattered, ScatterError> {
        let stream = Stream::new(seed, &format!("space/{}", self.stream));
        let table = self.table()?;
        let plan = ScatterPlan {
            spacing: self.spacing,
            is_plane: self.is_plane,
            joining: &self.joining,
            table: &table,
            fields: &self.fields,
            fixed,
            owner: None,
        };
        let Some(clusters) = &self.clusters else {
            let open = Open { shape: &self.shape, forbid: self.forbid.as_ref(), fixed };
            let graph = Scatter::new(&plan, &open, &stream)?;
            return Ok(Scattered { graph, spheres: Vec::new(), volumes: Vec::new() });
        };
        let coarse = Open { shape: &clusters.inside, forbid: None, fixed: &[] };
        let centres = poisson_points(&coarse, clusters.apart, self.is_plane, &stream.nth(1))?;
        if centres.is_empty() || centres.len() > MOST_CLUSTERS {
            return Err(ScatterError::Clusters { found: centres.len(), most: MOST_CLUSTERS });
        }
        let spheres: Vec<Shape> =
            centres.iter().map(|&centre| Shape::new(Solid::Sphere { centre, radius: clusters.radius })).collect();
        let volumes: Vec<Shape> = centres
            .iter()
            .zip(&spheres)
            .map(|(&centre, sphere)| {
                let cone = Shape::cone(centre, clusters.foot, [clusters.radius * 0.9, clusters.neck]);
                Shape::new(Solid::Union(cone.into_iter().chain([sphere.clone()]).collect()))
            })
            .collect();
        let whole = Shape::new(Solid::Union([self.shape.clone()].into_iter().chain(volumes.iter().cloned()).collect()));
        let owner = |p: DVec3| {
            if volumes.is_empty() || self.shape.contains(p) {
                return 0;
            }
            let margins = volumes.iter().map(|volume| volume.margin(p));
            let nearest = (1_u8..).zip(margins).min_by(|a, b| a.1.total_cmp(&b.1));
            nearest.map_or(0, |(owner, _)| owner)
        };
        let open = Open { shape: &whole, forbid: self.forbid.as_ref(), fixed };
        let graph = Scatter::new(&ScatterPlan { owner: Some(&owner), ..plan }, &open, &stream)?;
        Ok(Scattered { graph, spheres, volumes })
    }

    /// The graph of the space put at `place`, whose first node is there, and its shape.
    ///
    /// # Errors
    /// [`ScatterError`].
    pub(super) fn scatter_at(
        &self,
        place: &Place,
        table: &WeightTable,
        stream: &Stream,
    ) -> Result<(Scatter, Shape), ScatterError> {
        let shape = self.shape.placed(place.size, place.turn, place.at);
        let fixed = [place.at];
        let plan = ScatterPlan {
            spacing: self.spacing * place.size,
            is_plane: self.is_plane,
            joining: &self.joining,
            table,
            fields: &self.fields,
            fixed: &fixed,
            owner: None,
        };
        let open = Open { shape: &shape, forbid: self.forbid.as_ref(), fixed: &fixed };
        Ok((Scatter::new(&plan, &open, stream)?, shape))
    }
}
