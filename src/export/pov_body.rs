//! The bodies of POV-Ray objects: spheres, frusta and triangles, streamed.

use std::io::{self, Write};

use super::buffer::{BUFFER, flush_at};
use super::decimal::{number, push_number, push_vector, vector};
use super::pov_text::to_pov;
use crate::geom::frustum;
use crate::math::DVec3;
use crate::model::pattern::STEPS;
use crate::model::{Body, Digits, LimbFrame, Limbs, Material, Mesh, Object, Pose, limb_frames};

/// Writes what `object` is made of. Where its material has a pattern, limbs that are thick enough to show it have
/// `texture`, laid along them, and where it has tips, ends have theirs. `one` is what its mesh is declared as, where that has poses.
pub(super) fn write_body(
    object: &Object,
    material: &Material,
    texture: &str,
    one: &str,
    out: &mut impl Write,
) -> io::Result<()> {
    match &object.body {
        Body::Limbs(limbs) => write_limbs(limbs, object.digits, material, texture, out),
        Body::Mesh(mesh) => write_mesh(mesh, object.digits, out),
        Body::Posed(_, poses) => write_poses(poses, object.digits, one, out),
    }
}

fn write_limbs(
    limbs: &Limbs,
    digits: Digits,
    material: &Material,
    texture: &str,
    out: &mut impl Write,
) -> io::Result<()> {
    let frames = material.pattern.as_ref().map(|pattern| (limb_frames(limbs), pattern.figure()));
    let laid = |ball: u32| {
        if let Some(step @ 1..) = material.tips.map(|tips| tips.steps(limbs, ball)) {
            return Some(format!(" texture{{{}}}", tip_texture(texture, step)));
        }
        let (frames, figure) = frames.as_ref()?;
        let name = texture_at(texture, figure.clarity(limbs.balls[ball as usize].radius))?;
        Some(format!(" texture{{{name} {}}}", matrix(&frames[ball as usize], digits)))
    };
    let scale = digits.scale();
    let mut text = Vec::with_capacity(BUFFER + 256);
    for (i, ball) in (0..).zip(&limbs.balls) {
        text.extend_from_slice(b"sphere{");
        push_vector(&mut text, to_pov(ball.centre), digits, scale);
        text.push(b',');
        push_number(&mut text, ball.radius, digits, scale);
        text.extend_from_slice(laid(i).unwrap_or_default().as_bytes());
        text.extend_from_slice(b"}\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    for &[a, b] in &limbs.segments {
        let end = b;
        let (a, b) = (&limbs.balls[a as usize], &limbs.balls[b as usize]);
        let Some(f) = frustum(a.centre, a.radius, b.centre, b.radius) else { continue };
        let (from, to) = (to_pov(f.a), to_pov(f.b));
        let (ra, rb) = (digits.round(f.ra), digits.round(f.rb));
        // A cone without length or width is fatal to the whole file.
        if digits.round_point(from) == digits.round_point(to) || (ra == 0.0 && rb == 0.0) {
            continue;
        }
        text.extend_from_slice(b"cone{");
        push_vector(&mut text, from, digits, scale);
        text.push(b',');
        push_number(&mut text, ra, digits, scale);
        text.push(b',');
        push_vector(&mut text, to, digits, scale);
        text.push(b',');
        push_number(&mut text, rb, digits, scale);
        text.extend_from_slice(b" open");
        text.extend_from_slice(laid(end).unwrap_or_default().as_bytes());
        text.extend_from_slice(b"}\n");
        flush_at(&mut text, out, BUFFER)?;
    }
    flush_at(&mut text, out, 1)
}

/// The texture of so many steps of a material's tips.
pub(super) fn tip_texture(texture: &str, step: u8) -> String {
    format!("{texture}_Tip{step}")
}

/// The texture of limbs that show so much of a pattern; `None` where that is the object's own, without any.
pub(super) fn texture_at(texture: &str, clarity: f64) -> Option<String> {
    let step = libm::round(clarity * f64::from(STEPS)) as u32;
    match step {
        0 => None,
        STEPS => Some(texture.to_owned()),
        _ => Some(format!("{texture}_Young{step}")),
    }
}

/// Writes where limbs end, point by point.
pub(super) fn write_ends(limbs: &Limbs, digits: Digits, out: &mut impl Write) -> io::Result<()> {
    let ends = limbs.ends();
    let mut text = Vec::with_capacity(BUFFER + 256);
    for (i, &ball) in ends.iter().enumerate() {
        text.extend_from_slice(b"  ");
        push_vector(&mut text, to_pov(limbs.balls[ball as usize].centre), digits, digits.scale());
        text.extend_from_slice(if i + 1 < ends.len() { b",\n" } else { b"\n" });
        flush_at(&mut text, out, BUFFER)?;
    }
    flush_at(&mut text, out, 1)
}

/// Writes a mesh, which is declared as `one`, wherever it is posed.
fn write_poses(poses: &[Pose], digits: Digits, one: &str, out: &mut impl Write) -> io::Result<()> {
    let mut text = Vec::with_capacity(BUFFER + 256);
    for pose in poses {
        // Columns of the matrix are where the axes go; POV-Ray's are its rows.
        let axes = [pose.axes.x_axis, pose.axes.z_axis, pose.axes.y_axis].map(to_pov);
        let unit = Digits(Pose::DIGITS);
        text.extend_from_slice(format!("object{{{one} matrix<").as_bytes());
        for x in axes.iter().flat_map(DVec3::to_array) {
            push_number(&mut text, x, unit, unit.scale());
            text.push(b',');
        }
        let [x, y, z] = to_pov(pose.at).to_array().map(|x| number(x, digits));
        text.extend_from_slice(format!("{x},{y},{z}>}}\n").as_bytes());
        flush_at(&mut text, out, BUFFER)?;
    }
    flush_at(&mut text, out, 1)
}

/// The matrix that lays a texture along a limb.
fn matrix(frame: &LimbFrame, digits: Digits) -> String {
    let at = to_pov(frame.at - frame.axes[1] * frame.along);
    let unit = Digits(6);
    let mut numbers: Vec<String> =
        frame.axes.iter().flat_map(|&axis| to_pov(axis).to_array()).map(|x| number(x, unit)).collect();
    numbers.extend(at.to_array().map(|x| number(x, digits)));
    format!("matrix<{}>", numbers.join(","))
}

pub(super) fn write_mesh(mesh: &Mesh, digits: Digits, out: &mut impl Write) -> io::Result<()> {
    if mesh.triangles.is_empty() {
        return Ok(());
    }
    let list = |out: &mut dyn Write, name: &str, points: &[DVec3], digits: Digits| -> io::Result<()> {
        write!(out, "{name} {{ {}", points.len())?;
        for &p in points {
            write!(out, ",\n{}", vector(to_pov(p), digits))?;
        }
        writeln!(out, " }}")
    };
    writeln!(out, "mesh2 {{")?;
    list(out, "vertex_vectors", &mesh.points, digits)?;
    if !mesh.normals.is_empty() {
        list(out, "normal_vectors", &mesh.normals, Digits(6))?;
    }
    if !mesh.uvs.is_empty() {
        let unit = Digits(5);
        write!(out, "uv_vectors {{ {}", mesh.uvs.len() * 3)?;
        for [u, v] in mesh.uvs.iter().flatten() {
            write!(out, ",\n<{},{}>", number(*u, unit), number(*v, unit))?;
        }
        writeln!(out, " }}")?;
    }
    write!(out, "face_indices {{ {}", mesh.triangles.len())?;
    for [a, b, c] in &mesh.triangles {
        write!(out, ",\n<{a},{b},{c}>")?;
    }
    if !mesh.uvs.is_empty() {
        write!(out, " }}\nuv_indices {{ {}", mesh.uvs.len())?;
        for i in (0..mesh.uvs.len()).map(|i| i * 3) {
            write!(out, ",\n<{},{},{}>", i, i + 1, i + 2)?;
        }
    }
    writeln!(out, " }}\n}}")
}
