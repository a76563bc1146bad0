//! What stands about a scene's objects, as RIB takes it: renderers split without end what reaches behind the camera.

use crate::math::DVec3;
use crate::model::{Body, Camera, Instance, Mesh, Object};

/// What of `object` stands farther than `near` along the view: triangles where it stands once, whole copies where it stands in
/// several places.
pub(super) fn in_front(object: &Object, camera: &Camera, near: f64) -> Object {
    let [.., forwards] = camera.frame();
    let depth = |p: DVec3| (p - camera.at).dot(forwards);
    let mut object = object.clone();
    if let ([place], Body::Mesh(mesh)) = (&object.instances[..], &mut object.body) {
        let (place, points) = (*place, &mesh.points);
        mesh.triangles.retain(|triangle| triangle.iter().all(|&i| depth(place.to_world(points[i as usize])) > near));
        return object;
    }
    let radius = match &object.body {
        Body::Mesh(Mesh { points, .. }) => points.iter().map(|p| p.length()).fold(0.0, f64::max),
        Body::Limbs(_) | Body::Posed(..) => object.body.bounds().size().length(),
    };
    object.instances.retain(|place: &Instance| depth(place.at) - radius * place.scale > near);
    object
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{CameraSpec, Digits};

    #[test]
    fn nothing_reaches_behind_the_camera() {
        let balls = [(DVec3::ZERO, 1.0)];
        let camera = Camera::new(&CameraSpec::default(), 1.0, balls.into_iter()).unwrap();
        let [.., forwards] = camera.frame();
        let step = |far: f64| camera.at + forwards * far;
        let across = forwards.cross(DVec3::Z);
        let triangle = |far: f64| [step(far), step(far) + across, step(far + 0.5)];
        let points: Vec<DVec3> = [-2.0, -0.2, 3.0].into_iter().flat_map(triangle).collect();
        let mesh = Mesh { points, triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]], ..Mesh::default() };
        let once = Object::new("terrain", Body::Mesh(mesh), DVec3::ZERO, Digits(4), 0);
        let Body::Mesh(cut) = in_front(&once, &camera, 0.1).body else { panic!("it was a mesh") };
        assert_eq!(cut.triangles, [[6, 7, 8]]);
        let blade =
            Mesh { points: vec![DVec3::ZERO, DVec3::X, DVec3::Z], triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let turf = Object::new("grass", Body::Mesh(blade), DVec3::ZERO, Digits(4), 0);
        let instances = [-3.0, 0.5, 2.0, 4.0].map(|far| Instance::at(step(far))).to_vec();
        let many = in_front(&Object { instances, ..turf }, &camera, 0.1);
        assert_eq!(many.instances.len(), 2);
    }
}
