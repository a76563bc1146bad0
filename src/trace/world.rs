//! A model in trees: what a ray meets.

use super::laid::{Laid, Spread};
use super::posed::{self, PosedTree, PosedTriangle};
use super::standing::Standing;
use crate::bvh::{Boxes, Cones, Entry, Hit, Ray, RoundCone, Triangle, Triangles};
use crate::geom::Bounds;
use crate::math::DVec3;
use crate::model::{Body, Dome, LimbFrame, Limbs, Mesh, Model, Object, Tips};

/// Rays from surfaces start this far off them, as a share of the world's size: more than single precision loses.
const OFF: f64 = 2e-5;

/// A model ready to be traced.
pub struct World<'a> {
    /// What it was made of.
    pub model: &'a Model,
    /// The light of the sky.
    pub dome: Dome,
    shapes: Vec<ObjectShape<'a>>,
    /// Object and place of each box.
    instances: Vec<(u32, Standing)>,
    boxes: Boxes,
    /// Leaves and what else is posed; not among the instances.
    posed: PosedTree<'a>,
    /// The patterns of objects without limbs, by object.
    spread: Vec<Option<Spread>>,
    /// The ground's pattern.
    ground: Option<Spread>,
    /// The first number of each object's branches among all.
    branches: Vec<u32>,
    /// How far rays from surfaces start off them.
    pub(super) off: f64,
}

/// An object in its own space.
enum ObjectShape<'a> {
    Limbs(LimbShape<'a>),
    Mesh(&'a Mesh, Triangles),
}

/// Round cones.
struct LimbShape<'a> {
    limbs: &'a Limbs,
    cones: Cones,
    /// Balls that no segment joins.
    lone: Vec<u32>,
    pattern: Option<Laid>,
    tips: Option<Tips>,
}

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Distance along the ray.
    pub t: f64,
    /// Where it is.
    pub point: DVec3,
    /// Unit normal, towards where the ray came from.
    pub normal: DVec3,
    /// The normal of a limb without the relief of its pattern, zero for all else.
    pub face: DVec3,
    /// As POV-Ray has it: the normal of a smooth mesh is turned to where the ray came from, though its triangle may face there, and that
    /// of a rough limb may face away.
    pub turned: DVec3,
    /// The object, or `None` for the ground.
    pub object: Option<u32>,
    /// The limb, counted through all objects.
    pub branch: u32,
    /// Path cost.
    pub cost: f64,
    /// The round of growth that made it.
    pub level: u16,
    /// The share of the material's pattern.
    pub pattern: f64,
    /// The steps of the material's tips.
    pub tip: u8,
    /// Is it the lower side of a triangle?
    pub is_below: bool,
    /// Seen from within a solid, which no light reaches.
    pub is_inside: bool,
}

/// A solid that holds the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Within {
    instance: u32,
    id: u32,
}

impl<'a> LimbShape<'a> {
    fn new(limbs: &'a Limbs, pattern: Option<Laid>, tips: Option<Tips>) -> Self {
        let empty = Cones::new(0, |_| unreachable!("there is none"));
        let mut shape = Self { limbs, cones: empty, lone: limbs.lone(), pattern, tips };
        shape.cones = Cones::new(shape.count(), |i| shape.cone(i as u32).0);
        shape
    }

    fn count(&self) -> usize {
        self.limbs.segments.len() + self.lone.len()
    }

    /// The round cone of a hit, and its two balls.
    fn cone(&self, id: u32) -> (RoundCone, [u32; 2]) {
        let [a, b] = match self.limbs.segments.get(id as usize) {
            Some(&segment) => segment,
            None => [self.lone[id as usize - self.limbs.segments.len()]; 2],
        };
        let [from, to] = [a, b].map(|i| &self.limbs.balls[i as usize]);
        (RoundCone { a: from.centre, ra: from.radius, b: to.centre, rb: to.radius }, [a, b])
    }
}

impl<'a> ObjectShape<'a> {
    fn new(object: &'a Object, model: &Model) -> Self {
        match &object.body {
            Body::Limbs(limbs) => {
                let pattern = model.materials[object.material].1.pattern.map(|pattern| Laid::new(pattern, limbs));
                Self::Limbs(LimbShape::new(limbs, pattern, model.materials[object.material].1.tips))
            }
            Body::Mesh(mesh) | Body::Posed(mesh, _) => {
                Self::Mesh(mesh, Triangles::new(mesh.triangles.len(), |i| triangle(mesh, i)))
            }
        }
    }

    fn bounds(&self) -> Bounds {
        match self {
            Self::Limbs(limbs) => limbs.cones.bounds(),
            Self::Mesh(_, triangles) => triangles.bounds(),
        }
    }

    fn closest(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Limbs(limbs) => limbs.cones.closest(ray),
            Self::Mesh(_, triangles) => triangles.closest(ray),
        }
    }

    fn is_blocked(&self, ray: &Ray) -> bool {
        match self {
            Self::Limbs(limbs) => limbs.cones.is_blocked(ray),
            Self::Mesh(_, triangles) => triangles.is_blocked(ray),
        }
    }
}

/// A normal on the side from which `way` comes.
fn against(way: DVec3, normal: DVec3) -> DVec3 {
    if normal.dot(way) > 0.0 { -normal } else { normal }
}

/// The normal of a smooth mesh on the side from which `way` comes to its triangle, whose own normal is `flat`; where it looks the
/// other way, as it may behind a crest, the nearest one that does not.
fn towards(way: DVec3, flat: DVec3, normal: DVec3) -> DVec3 {
    let normal = if flat.dot(way) > 0.0 { -normal } else { normal };
    let away = normal.dot(way);
    if away > 0.0 { (normal - way * away).normalize_or(normal) } else { normal }
}

fn triangle(mesh: &Mesh, i: usize) -> Triangle {
    Triangle(mesh.triangles[i].map(|p| mesh.points[p as usize]))
}

impl<'a> World<'a> {
    /// Bytes that the trees over `model` take at their peak.
    #[must_use]
    pub fn bytes_needed(model: &Model) -> u64 {
        let in_tree = posed::in_tree(model);
        let of = |(object, is_in_tree): (&Object, &bool)| {
            let shapes = match &object.body {
                Body::Limbs(limbs) => {
                    let has_pattern = model.materials[object.material].1.pattern.is_some();
                    let frames = if has_pattern { limbs.balls.len() * size_of::<LimbFrame>() } else { 0 };
                    Cones::bytes_needed(limbs.segments.len().max(limbs.balls.len())) + frames
                }
                Body::Mesh(mesh) | Body::Posed(mesh, _) => Triangles::bytes_needed(mesh.triangles.len()),
            };
            let poses = match &object.body {
                Body::Posed(..) if *is_in_tree => 0,
                Body::Posed(_, poses) => poses.len(),
                Body::Limbs(_) | Body::Mesh(_) => 1,
            };
            let places = poses * object.instances.len();
            shapes + places * size_of::<(u32, Standing)>() + Boxes::bytes_needed(places)
        };
        let each = model.objects.iter().zip(&in_tree).map(|object| of(object) as u64);
        posed::bytes_needed(model, &in_tree) as u64 + each.sum::<u64>()
    }

    /// Puts `model` into trees.
    #[must_use]
    pub fn new(model: &'a Model) -> Self {
        let shapes: Vec<ObjectShape<'_>> = model.objects.iter().map(|object| ObjectShape::new(object, model)).collect();
        let in_tree = posed::in_tree(model);
        let mut instances: Vec<(u32, Standing)> = Vec::new();
        for (i, object) in (0..).zip(&model.objects) {
            for instance in &object.instances {
                match &object.body {
                    Body::Posed(..) if in_tree[i as usize] => {}
                    Body::Posed(_, poses) => {
                        instances.extend(poses.iter().map(|pose| (i, Standing::posed(instance, pose))));
                    }
                    Body::Limbs(_) | Body::Mesh(_) => instances.push((i, Standing::whole(instance))),
                }
            }
        }
        let boxes: Vec<_> = instances
            .iter()
            .map(|(object, place)| {
                let corners = shapes[*object as usize].bounds().corners();
                let corners = corners.map(|p| Bounds::of_ball(place.to_world(p), 0.0));
                corners.into_iter().fold(Bounds::EMPTY, Bounds::union)
            })
            .collect();
        let mut next = 0;
        let branches = model
            .objects
            .iter()
            .map(|o| {
                let first = next;
                next += o.body.branches();
                first
            })
            .collect();
        let size = model.bounds();
        let reach = if size.is_empty() { 1.0 } else { size.min.abs().max(size.max.abs()).max_element() };
        let pattern = |object: &Object| model.materials[object.material].1.pattern;
        let spread = model.objects.iter().map(|object| pattern(object).map(Spread::on_mesh)).collect();
        let ground = model.ground.as_ref().and_then(|ground| ground.material.pattern).map(Spread::on_ground);
        let (dome, boxes) = (Dome::new(model), Boxes::new(&boxes));
        Self {
            model,
            dome,
            shapes,
            boxes,
            instances,
            posed: PosedTree::new(model, &in_tree),
            spread,
            ground,
            branches,
            off: reach * OFF,
        }
    }

    /// The name of each branch as [`SurfaceHit::branch`] counts them: `object.limb`.
    #[must_use]
    pub fn branch_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        for object in &self.model.objects {
            names.extend((0..object.body.branches()).map(|i| format!("{}.{i}", object.name)));
        }
        names
    }

    /// The solids that hold `p`: a camera there sees them from within.
    pub(super) fn within(&self, p: DVec3) -> Vec<Within> {
        let mut found = Vec::new();
        for (instance, (object, place)) in (0..).zip(&self.instances) {
            let (ObjectShape::Limbs(shape), own) = (&self.shapes[*object as usize], place.to_own(p)) else { continue };
            let bounds = shape.cones.bounds();
            if own.cmpge(bounds.min).all() && own.cmple(bounds.max).all() {
                let holds = |id: &u32| shape.cone(*id).0.holds(own);
                found.extend((0..shape.count() as u32).filter(holds).map(|id| Within { instance, id }));
            }
        }
        found
    }

    /// The nearest thing on the ray, `within` being the solids that hold its origin. What is not `seen`, but lights what is, has its
    /// pattern's mean.
    pub(super) fn closest(&self, ray: &Ray, within: &[Within], seen: bool) -> Option<SurfaceHit> {
        let mut ray = *ray;
        let ground = self.ground(&ray, seen);
        if let Some(surface) = &ground {
            ray.far = surface.t;
        }
        let leaf = self.posed.closest(&ray);
        if let Some(hit) = &leaf {
            ray.far = hit.t;
        }
        let mut best: Option<(u32, f64, u32)> = None;
        self.meet(&ray, &mut |instance, far| {
            let (object, place) = &self.instances[instance as usize];
            let (own, scale) = place.ray(&Ray { far, ..ray });
            if let Some(hit) = self.shapes[*object as usize].closest(&own) {
                best = Some((instance, hit.t * scale, hit.id));
            }
            best.map_or(far, |(_, t, _)| t.min(far))
        });
        let mut surface = match (best, leaf) {
            (Some((instance, t, id)), _) => Some(self.surface(&ray, instance, t, id, seen)),
            (None, Some(hit)) => Some(self.on_leaf(&ray, hit.t, hit.id, seen)),
            (None, None) => ground,
        };
        for w in within {
            let (object, place) = &self.instances[w.instance as usize];
            let ObjectShape::Limbs(shape) = &self.shapes[*object as usize] else { continue };
            let (cone, balls) = shape.cone(w.id);
            let (own, scale) = place.ray(&ray);
            if let Some(entry) = cone.inner(&own)
                && surface.is_none_or(|s| entry.t * scale < s.t)
            {
                let inner = self.on_cone(&ray, w.instance, entry.t * scale, (Some(entry), seen), shape, (&cone, balls));
                surface = Some(SurfaceHit { is_inside: true, ..inner });
            }
        }
        surface
    }

    /// The surface of a hit in the tree of posed meshes.
    fn on_leaf(&self, ray: &Ray, t: f64, id: u32, seen: bool) -> SurfaceHit {
        let PosedTriangle { object, mesh, instance, pose, triangle } = self.posed.triangle(id);
        self.on_mesh(ray, (object, &Standing::posed(instance, pose)), t, (mesh, triangle), seen)
    }

    /// The surface of a hit.
    fn surface(&self, ray: &Ray, instance: u32, t: f64, id: u32, seen: bool) -> SurfaceHit {
        let (object, place) = &self.instances[instance as usize];
        match &self.shapes[*object as usize] {
            ObjectShape::Mesh(mesh, _) => self.on_mesh(ray, (*object, place), t, (mesh, id), seen),
            ObjectShape::Limbs(shape) => {
                let (own, _) = place.ray(ray);
                let (cone, balls) = shape.cone(id);
                self.on_cone(ray, instance, t, (cone.enter(&own), seen), shape, (&cone, balls))
            }
        }
    }

    /// Does anything that casts shadows stand in the way?
    pub(super) fn is_blocked(&self, ray: &Ray) -> bool {
        let mut met = self.posed.is_blocked(ray);
        if met {
            return true;
        }
        self.meet(ray, &mut |instance, far| {
            let (object, place) = &self.instances[instance as usize];
            if !self.model.objects[*object as usize].shadow {
                return far;
            }
            let (own, _) = place.ray(ray);
            met = self.shapes[*object as usize].is_blocked(&own);
            if met { f64::NEG_INFINITY } else { far }
        });
        met
    }

    /// Shows `test` the instances near the ray; most scenes have one.
    fn meet(&self, ray: &Ray, test: &mut dyn FnMut(u32, f64) -> f64) {
        if self.instances.len() == 1 {
            test(0, ray.far);
        } else {
            self.boxes.meet(ray, test);
        }
    }

    fn ground(&self, ray: &Ray, seen: bool) -> Option<SurfaceHit> {
        let ground = self.model.ground.as_ref()?;
        let t = (ground.height - ray.origin.z) / ray.direction.z;
        let point = ray.at(t);
        let is_met = t > ray.near && t < ray.far;
        let is_on = ground.radius.is_none_or(|r| point.x * point.x + point.y * point.y <= r * r);
        let normal = against(ray.direction, DVec3::Z);
        (is_met && is_on).then_some(SurfaceHit {
            t,
            point,
            normal,
            face: DVec3::ZERO,
            turned: normal,
            object: None,
            branch: 0,
            cost: 0.0,
            level: 0,
            tip: 0,
            pattern: self.ground.as_ref().map_or(0.0, |pattern| pattern.at(point, seen)),
            is_below: false,
            is_inside: false,
        })
    }

    fn on_cone(
        &self,
        ray: &Ray,
        instance: u32,
        t: f64,
        (entry, seen): (Option<Entry>, bool),
        shape: &LimbShape<'_>,
        (cone, balls): (&RoundCone, [u32; 2]),
    ) -> SurfaceHit {
        let (index, place) = &self.instances[instance as usize];
        let (own, scale) = place.ray(ray);
        // In double precision, unless the two disagree whether it is met at all.
        let (t, normal, share) = match entry {
            Some(entry) => (entry.t * scale, entry.normal, entry.share),
            None => (t, cone.normal_at(own.at(t / scale)), 1.0),
        };
        let [a, b] = balls.map(|i| &shape.limbs.balls[i as usize]);
        let at = if share > 0.0 { 1 } else { 0 };
        let radius = shape.limbs.balls[balls[at] as usize].radius;
        let laid = shape.pattern.as_ref().map(|laid| laid.at(balls[at], radius, own.at(t / scale), seen));
        let (pattern, slope) = laid.unwrap_or_default();
        let flat = against(ray.direction, place.normal(normal));
        // What is not the limb's own inside, seen from within.
        let outwards = if flat.dot(place.normal(normal)) > 0.0 { 1.0 } else { -1.0 };
        let rough = place.normal(normal - slope) * outwards;
        let normal = towards(ray.direction, flat, rough);
        SurfaceHit {
            t,
            point: ray.at(t),
            normal,
            face: flat,
            turned: rough,
            object: Some(*index),
            branch: self.branches[*index as usize] + [a, b][at].branch,
            cost: a.cost + (b.cost - a.cost) * share,
            level: [a, b][at].level,
            tip: shape.tips.map_or(0, |tips| tips.steps(shape.limbs, balls[at])),
            pattern,
            is_below: false,
            is_inside: false,
        }
    }

    fn on_mesh(
        &self,
        ray: &Ray,
        (index, place): (u32, &Standing),
        t: f64,
        (mesh, id): (&Mesh, u32),
        seen: bool,
    ) -> SurfaceHit {
        let triangle = triangle(mesh, id as usize);
        let (own, scale) = place.ray(ray);
        let (t, [v, w]) = match triangle.meet(&own) {
            Some((t, weights)) => (t * scale, weights),
            None => (t, [0.0; 2]),
        };
        let flat = triangle.normal();
        let corners = mesh.triangles[id as usize];
        let normal = match mesh.normals.get(corners[0] as usize) {
            Some(&a) => {
                let [b, c] = [corners[1], corners[2]].map(|i| mesh.normals[i as usize]);
                (a + (b - a) * v + (c - a) * w).normalize_or(flat)
            }
            None => flat,
        };
        let [flat, normal] = [flat, normal].map(|normal| place.normal(normal));
        SurfaceHit {
            t,
            point: ray.at(t),
            normal: towards(ray.direction, flat, normal),
            face: DVec3::ZERO,
            turned: against(ray.direction, normal),
            object: Some(index),
            branch: self.branches[index as usize],
            cost: 0.0,
            level: 0,
            tip: 0,
            pattern: self.spread[index as usize].as_ref().map_or(0.0, |pattern| pattern.at(own.at(t / scale), seen)),
            is_below: flat.dot(ray.direction) > 0.0,
            is_inside: false,
        }
    }
}
