//! A space of scattered nodes: as it is, or around the end of a limb.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::geom::{Bounds, Shape, ShapeSpec, Solid};
use crate::graph::{
    CostField, EdgeWeights, Joining, Region, Scatter, ScatterError, ScatterPlan, WeightError, WeightTable,
    poisson_points, scatter_bytes, scatter_estimate, spacing_of_kept,
};
use crate::math::{DMat3, DVec3, Point, Stream, Weights};

/// Scattered nodes, joined to the nearest in each sector (a Yao graph) or within a radius.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScatterSpec {
    /// Least distance between nodes, in scene units; in the space of a repeated step times its size.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub spacing: f64,
    /// Sectors of the Yao graph: 6, 8 (the orthants) or 24 in space, 3 to 24 in the plane. By default 8 and 6.
    #[serde(default)]
    #[schemars(range(min = 3, max = 24))]
    pub sectors: Option<u32>,
    /// Longest edge of the Yao graph, in spacings. By default edges are of any length (2012, section 3.1), and bridge what the shape
    /// leaves out: trees leave it where it bends or parts.
    #[serde(default)]
    #[schemars(range(min = 1, max = 1e6))]
    pub longest: Option<f64>,
    /// In place of the Yao graph: all nodes no farther apart than this are joined, in scene units, also where the space of
    /// a repeated step is scaled.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub radius: Option<f64>,
    /// Do they lie in the plane, with y up?
    #[serde(default)]
    pub plane: bool,
    /// The share of the nodes that are kept, at random. Nodes fill their space evenly, until there is no room for another; the fewer
    /// are kept, the more unevenly they lie, and a graph within a `radius` falls apart (2012, Fig. 22).
    #[serde(default = "all")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub keep: f64,
}

fn all() -> f64 {
    1.0
}

/// A few volumes within a coarse shape: a sphere about each of a few points far apart, and a cone from it to the trunk
/// (2012, section 3.3.1, Figs. 12 and 13).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClustersSpec {
    /// The coarse shape in which the points lie.
    pub inside: ShapeSpec,
    /// Least distance between the points; there is no room for another.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub apart: f64,
    /// Radius of the spheres.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub radius: f64,
    /// Where the cones end: on the trunk, which is the space's own shape.
    pub foot: Point,
    /// Radius of the cones at their foot.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    pub neck: f64,
}

/// Scattered nodes in a shape, whose names and files are resolved.
#[derive(Clone, Debug)]
pub struct ScatterSpace {
    /// Where nodes are.
    pub shape: Shape,
    /// Where none are, in the scene's own coordinates.
    pub forbid: Option<Shape>,
    /// Least distance between nodes.
    pub spacing: f64,
    /// The share of the nodes that are kept.
    pub keep: f64,
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

impl Clusters {
    /// What spheres and cones lie in, wherever their points are.
    fn bounds(&self) -> Bounds {
        let foot = Bounds { min: self.foot, max: self.foot }.grown(self.neck);
        self.inside.bounds().grown(self.radius).union(foot)
    }
}

/// Clusters are counted in a byte.
pub const MOST_CLUSTERS: usize = 64;

/// Where a space is used: scaled, turned and moved; its random numbers are of its own.
#[derive(Clone, Copy, Debug)]
pub struct SubgraphPlace {
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
pub(in crate::grow) struct Scattered {
    pub graph: Scatter,
    pub weights: EdgeWeights,
    /// The spheres of its clusters; owner i has the sphere i - 1.
    pub spheres: Vec<Shape>,
    /// The cluster volumes, for drawings.
    pub volumes: Vec<Shape>,
}

impl ScatterSpace {
    /// Every shape in it, to change.
    pub(in crate::grow) fn shapes_mut(&mut self) -> Vec<&mut Shape> {
        let clusters = self.clusters.as_mut().map(|clusters| &mut clusters.inside);
        let fields = self.fields.iter_mut().filter_map(CostField::shape_mut);
        std::iter::once(&mut self.shape).chain(&mut self.forbid).chain(clusters).chain(fields).collect()
    }

    /// Index of the coordinate that points up: y in the plane, z in space.
    #[must_use]
    pub fn up(&self) -> usize {
        if self.is_plane { 1 } else { 2 }
    }

    /// Up: y in the plane, z in space.
    pub(in crate::grow) fn up_vector(&self) -> DVec3 {
        if self.is_plane { DVec3::Y } else { DVec3::Z }
    }

    /// About how many nodes it has.
    #[must_use]
    pub fn estimate(&self) -> f64 {
        let own = self.shape.bounds();
        let bounds = self.clusters.as_ref().map_or(own, |clusters| own.union(clusters.bounds()));
        scatter_estimate([bounds.min, bounds.max], self.spacing, self.is_plane)
    }

    /// About how many edges it has, each counted twice, where nodes are joined within a radius.
    #[must_use]
    pub fn edges_estimate(&self) -> f64 {
        let nodes = self.estimate() * self.keep;
        let apart = spacing_of_kept(self.spacing, self.keep, self.is_plane);
        nodes * self.joining.degree(nodes, apart, self.is_plane)
    }

    /// Bytes that planning in it takes at its peak.
    #[must_use]
    pub fn bytes_needed(&self) -> u64 {
        // Where clusters lie is not known.
        let is_open = |p: DVec3| self.shape.contains(p) && !self.forbid.as_ref().is_some_and(|f| f.contains(p));
        let share = if self.clusters.is_some() { 1.0 } else { self.shape.bounds().share(is_open) };
        // Those of a Yao graph are counted with the nodes.
        let more = (self.edges_estimate() - 12.0 * self.estimate() * self.keep).max(0.0) * 16.0;
        scatter_bytes(self.estimate(), share * self.keep).saturating_add((more * share) as u64)
    }

    /// The table of its weights.
    ///
    /// # Errors
    /// Where they are out of range.
    pub fn table(&self) -> Result<WeightTable, WeightError> {
        WeightTable::new(self.weights, 1.0, 0.0)
    }

    /// The graph of a scene with this seed, with nodes at `fixed` as far as these are apart.
    ///
    /// # Errors
    /// [`ScatterError`].
    pub(in crate::grow) fn scatter(
        &self,
        table: &WeightTable,
        seed: u64,
        fixed: &[DVec3],
    ) -> Result<Scattered, ScatterError> {
        let stream = Stream::new(seed, &format!("space/{}", self.stream));
        let weigh = |graph: &Scatter| graph.weigh(table, &self.fields, |p| p, &stream);
        let plan = ScatterPlan {
            spacing: self.spacing,
            keep: self.keep,
            is_plane: self.is_plane,
            joining: &self.joining,
            fixed,
            owner: None,
        };
        let Some(clusters) = &self.clusters else {
            let open = Open { shape: &self.shape, forbid: self.forbid.as_ref(), fixed };
            let graph = Scatter::new(&plan, &open, &stream)?;
            let weights = weigh(&graph);
            return Ok(Scattered { graph, weights, spheres: Vec::new(), volumes: Vec::new() });
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
        let weights = weigh(&graph);
        Ok(Scattered { graph, weights, spheres, volumes })
    }

    /// May ends share nodes? Not where something is forbidden, or joined by a length in the scene's units.
    pub(in crate::grow) fn is_alike(&self) -> bool {
        self.forbid.is_none() && matches!(self.joining, Joining::Yao { .. } | Joining::Triangular)
    }

    /// Nodes around an end, in the space's own coordinates; the first is the end. What is forbidden, in the scene's
    /// coordinates, is left out where the space is put at `place`.
    ///
    /// # Errors
    /// [`ScatterError`].
    pub(in crate::grow) fn scatter_around(
        &self,
        place: Option<&SubgraphPlace>,
        stream: &Stream,
    ) -> Result<Scatter, ScatterError> {
        let fixed = [DVec3::ZERO];
        let joining = match (&self.joining, place) {
            (Joining::Radius(reach), Some(place)) => Joining::Radius(reach / place.size),
            (joining, _) => joining.clone(),
        };
        let plan = ScatterPlan {
            spacing: self.spacing,
            keep: self.keep,
            is_plane: self.is_plane,
            joining: &joining,
            fixed: &fixed,
            owner: None,
        };
        let forbid = self.forbid.as_ref().zip(place).map(|(forbid, place)| {
            let back = place.turn.transpose();
            forbid.placed(1.0 / place.size, back, back * place.at * (-1.0 / place.size))
        });
        let open = Open { shape: &self.shape, forbid: forbid.as_ref(), fixed: &fixed };
        Scatter::new(&plan, &open, stream)
    }
}

impl SubgraphPlace {
    /// Where a point of the space is put.
    pub fn put(&self, p: DVec3) -> DVec3 {
        self.turn * (p * self.size) + self.at
    }
}
