//! Schematics: black tapered strokes on white, as in the papers, and construction drawings.

use std::io::{self, Write};

use super::identifier::plain;
use crate::geom::{Mark, MarkKind};
use crate::math::{DVec2, DVec3};
use crate::model::{Body, Camera, Limbs, Material, Mesh, Model, Projected};

/// How a schematic is drawn.
#[derive(Clone, Copy, Debug)]
pub struct SvgOptions {
    /// Size of the picture, in pixels.
    pub size: [u32; 2],
}

/// So many nodes or edges are drawn as wide as any line.
const FEW_MARKS: f64 = 1000.0;
/// Steps of tone and width that edges have by what they cost.
const COST_STEPS: u32 = 8;
/// No stroke is drawn thinner than this radius, in pixels: it would vanish.
const HAIRLINE: f64 = 0.35;

/// Writes `model`, seen from its camera, as an SVG picture.
///
/// # Errors
/// What `out` says.
pub fn write_svg(model: &Model, options: SvgOptions, mut out: impl Write) -> io::Result<()> {
    let [width, height] = options.size;
    writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">"#
    )?;
    writeln!(out, "<title>{}</title>", escape(&plain(&model.title)))?;
    writeln!(out, r##"<rect width="{width}" height="{height}" fill="#fff"/>"##)?;
    let view = Sheet { camera: &model.camera, size: options.size };
    // What paths run over comes first, what they run between last.
    write_costs(&model.marks, view, &mut out)?;
    for kind in [MarkKind::Edges, MarkKind::Nodes, MarkKind::Sectors, MarkKind::Contours, MarkKind::Shapes] {
        write_marks(&model.marks, kind, view, &mut out)?;
    }
    for object in &model.objects {
        let (_, material) = &model.materials[object.material];
        write!(out, r#"<path fill="{}" d=""#, ink(material))?;
        for place in &object.instances {
            let disc = |p: DVec3, radius: f64| view.disc(place.to_world(p), radius * place.scale);
            match &object.body {
                Body::Limbs(limbs) => write_limbs(limbs, &disc, &mut out)?,
                Body::Mesh(mesh) => write_triangles(mesh, &|p| p, &disc, &mut out)?,
                Body::Posed(mesh, poses) => {
                    for pose in poses {
                        write_triangles(mesh, &|p| pose.to_object(p), &disc, &mut out)?;
                    }
                }
            }
        }
        writeln!(out, r#""/>"#)?;
    }
    write_marks(&model.marks, MarkKind::Endpoints, view, &mut out)?;
    writeln!(out, "</svg>")
}

fn write_limbs(limbs: &Limbs, disc: &dyn Fn(DVec3, f64) -> Option<Disc>, out: &mut impl Write) -> io::Result<()> {
    let balls: Vec<Option<Disc>> = limbs.balls.iter().map(|ball| disc(ball.centre, ball.radius)).collect();
    for &[a, b] in &limbs.segments {
        if let (Some(a), Some(b)) = (balls[a as usize], balls[b as usize]) {
            write_stroke(a, b, out)?;
        }
    }
    // Balls within strokes are drawn with them already.
    if limbs.segments.is_empty() {
        for disc in balls.into_iter().flatten() {
            write_stroke(disc, disc, out)?;
        }
    }
    Ok(())
}

fn write_triangles(
    mesh: &Mesh,
    pose: &dyn Fn(DVec3) -> DVec3,
    disc: &dyn Fn(DVec3, f64) -> Option<Disc>,
    out: &mut impl Write,
) -> io::Result<()> {
    for corners in &mesh.triangles {
        if let [Some(a), Some(b), Some(c)] = corners.map(|i| disc(pose(mesh.points[i as usize]), 0.0)) {
            let [a, b, c] = [a, b, c].map(|disc| disc.centre);
            writeln!(out, "M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}z", a.x, a.y, b.x, b.y, c.x, c.y)?;
        }
    }
    Ok(())
}

/// A ball as it is seen, in pixels.
#[derive(Clone, Copy)]
struct Disc {
    centre: DVec2,
    radius: f64,
}

#[derive(Clone, Copy)]
struct Sheet<'a> {
    camera: &'a Camera,
    size: [u32; 2],
}

impl Sheet<'_> {
    /// A pixel of a picture whose shorter side has 600.
    fn unit(&self) -> f64 {
        f64::from(self.size[0].min(self.size[1])) / 600.0
    }

    fn disc(&self, centre: DVec3, radius: f64) -> Option<Disc> {
        let Projected { x, y, scale, .. } = self.camera.project(centre)?;
        let [width, height] = self.size.map(f64::from);
        Some(Disc { centre: DVec2::new(x * width, y * height), radius: (radius * scale * width).max(HAIRLINE) })
    }
}

/// The outline of a round cone seen from the side: two arcs and the tangents between them, clockwise.
fn write_stroke(a: Disc, b: Disc, out: &mut impl Write) -> io::Result<()> {
    let way = b.centre - a.centre;
    let length = way.length();
    let sin = (a.radius - b.radius) / length;
    // Not a number where the discs share their middle.
    if sin.is_nan() || sin.abs() >= 1.0 {
        let Disc { centre: c, radius: r } = if a.radius > b.radius { a } else { b };
        return writeln!(
            out,
            "M{:.2} {:.2}a{r:.2} {r:.2} 0 1 1 {:.2} 0a{r:.2} {r:.2} 0 1 1 {:.2} 0z",
            c.x - r,
            c.y,
            2.0 * r,
            -2.0 * r
        );
    }
    let (u, cos) = (way / length, libm::sqrt(1.0 - sin * sin));
    let side = DVec2::new(-u.y, u.x);
    // Where the tangents touch, on one side and the other.
    let touch = |disc: Disc, sign: f64| disc.centre + (u * sin + side * (sign * cos)) * disc.radius;
    let [a1, b1, b2, a2] = [touch(a, -1.0), touch(b, -1.0), touch(b, 1.0), touch(a, 1.0)];
    let (ra, rb) = (a.radius, b.radius);
    // The larger disc shows more than half of itself.
    let (large_a, large_b) = (u8::from(ra > rb), u8::from(rb > ra));
    writeln!(
        out,
        "M{:.2} {:.2}L{:.2} {:.2}A{rb:.2} {rb:.2} 0 {large_b} 1 {:.2} {:.2}L{:.2} {:.2}A{ra:.2} {ra:.2} 0 {large_a} 1 {:.2} {:.2}z",
        a1.x, a1.y, b1.x, b1.y, b2.x, b2.y, a2.x, a2.y, a1.x, a1.y
    )
}

/// Edges by what they cost, in steps: the least wide and dark, and over the others.
fn write_costs(marks: &[Mark], view: Sheet<'_>, out: &mut impl Write) -> io::Result<()> {
    let step = |mark: &Mark| ((mark.cost * f64::from(COST_STEPS)) as u32).min(COST_STEPS - 1);
    for at in (0..COST_STEPS).rev() {
        let share = f64::from(at) / f64::from(COST_STEPS - 1);
        let edges = marks.iter().filter(|mark| mark.kind == MarkKind::Costs && step(mark) == at);
        let lines: String = edges.map(|mark| polyline(&mark.line, view)).collect();
        let grey = (70.0 + 160.0 * share) as u8;
        let colour = &format!("#{grey:02x}{grey:02x}{grey:02x}");
        write_lines(
            &lines,
            &Pen { colour, width: (2.8 - 2.2 * share) * boldness(marks, MarkKind::Costs), is_dashed: false },
            view,
            out,
        )?;
    }
    Ok(())
}

/// How much wider than others the marks of a graph are drawn: by their number, up to twice where there are few.
fn boldness(marks: &[Mark], kind: MarkKind) -> f64 {
    let count = marks.iter().filter(|mark| mark.kind == kind).count();
    libm::sqrt(FEW_MARKS / count.max(1) as f64).clamp(0.5, 2.0)
}

/// Lines through the points, as they are seen.
fn polyline(line: &[DVec3], view: Sheet<'_>) -> String {
    let points = line.iter().filter_map(|&p| view.disc(p, 0.0)).zip(0_usize..);
    points
        .map(|(Disc { centre: p, .. }, i)| format!("{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, p.x, p.y))
        .collect()
}

/// What lines are drawn with.
struct Pen<'a> {
    colour: &'a str,
    /// In pixels of a picture of 600.
    width: f64,
    is_dashed: bool,
}

fn write_lines(lines: &str, pen: &Pen<'_>, view: Sheet<'_>, out: &mut impl Write) -> io::Result<()> {
    if lines.is_empty() {
        return Ok(());
    }
    let Pen { colour, is_dashed, .. } = pen;
    let width = pen.width * view.unit();
    let dash = if *is_dashed { format!(r#" stroke-dasharray="{:.2}""#, 4.0 * width) } else { String::new() };
    writeln!(
        out,
        r#"<path fill="none" stroke="{colour}" stroke-width="{width:.2}"{dash} stroke-linecap="round" d="{lines}"/>"#
    )
}

fn write_marks(marks: &[Mark], kind: MarkKind, view: Sheet<'_>, out: &mut impl Write) -> io::Result<()> {
    let bold = boldness(marks, kind);
    let (colour, width, radius) = match kind {
        MarkKind::Nodes => ("#888", 0.0, 1.2 * bold),
        MarkKind::Edges | MarkKind::Costs => ("#bbb", 0.6 * bold, 0.0),
        MarkKind::Sectors => ("#c22", 1.2, 0.0),
        MarkKind::Endpoints => ("#c22", 1.5, 4.0),
        MarkKind::Shapes => ("#38c", 1.2, 0.0),
        MarkKind::Contours => ("#c84", 0.8, 0.0),
    };
    let (dots, lines): (Vec<&Mark>, Vec<&Mark>) =
        marks.iter().filter(|mark| mark.kind == kind).partition(|mark| mark.line.len() == 1);
    let lines: String = lines.iter().map(|mark| polyline(&mark.line, view)).collect();
    write_lines(&lines, &Pen { colour, width, is_dashed: kind == MarkKind::Sectors }, view, out)?;
    if !dots.is_empty() {
        let (fill, stroke) = if kind == MarkKind::Endpoints { ("#fff", colour) } else { (colour, "none") };
        writeln!(out, r#"<g fill="{fill}" stroke="{stroke}" stroke-width="{:.2}">"#, width * view.unit())?;
        for Disc { centre: p, .. } in dots.iter().filter_map(|mark| view.disc(mark.line[0], 0.0)) {
            writeln!(out, r#"<circle cx="{:.2}" cy="{:.2}" r="{:.2}"/>"#, p.x, p.y, radius * view.unit())?;
        }
        writeln!(out, "</g>")?;
    }
    Ok(())
}

/// Ink: a material that glows in its own colour keeps it, everything else is black.
fn ink(material: &Material) -> String {
    if material.emission == 0.0 {
        return "#000".to_owned();
    }
    format!("#{}", material.colour.times(material.emission).hex())
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
