//! SVG: sketches in, schematics to pixels.

use resvg::tiny_skia::{self, PathSegment, Pixmap, Point, Transform};
use resvg::usvg::{self, Group, Node, Tree};

use super::Rgba;
use crate::math::DVec2;

/// Straight pieces that a curve becomes.
const PIECES: u32 = 24;
/// More points than this in a sketch are refused.
const MOST_POINTS: usize = 1_000_000;

/// The outlines of a sketch, in fractions of its page: x to the right, y up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Polylines, and whether each is closed.
    pub lines: Vec<(Vec<DVec2>, bool)>,
    /// The page's width over its height.
    pub aspect: f64,
}

impl Page {
    /// The middle of each closed outline, the end of each open one.
    pub fn points(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.lines.iter().filter_map(|(line, is_closed)| {
            if !is_closed {
                return line.last().copied();
            }
            let low = line.iter().copied().reduce(DVec2::min)?;
            let high = line.iter().copied().reduce(DVec2::max)?;
            Some((low + high) * 0.5)
        })
    }
}

/// The strokes and outlines of the SVG in `bytes`.
///
/// # Errors
/// A sentence: no SVG, no paths, or too many points.
pub fn decode_sketch(bytes: &[u8]) -> Result<Page, String> {
    let tree =
        Tree::from_data(bytes, &usvg::Options::default()).map_err(|e| format!("it is not an SVG picture: {e}"))?;
    let size = tree.size();
    let mut page = Page { lines: Vec::new(), aspect: f64::from(size.width()) / f64::from(size.height()) };
    let mut points = 0;
    visit(tree.root(), &tree, &mut page, &mut points)?;
    if page.lines.is_empty() {
        return Err("it has no paths".to_owned());
    }
    Ok(page)
}

fn visit(group: &Group, tree: &Tree, page: &mut Page, points: &mut usize) -> Result<(), String> {
    for node in group.children() {
        match node {
            Node::Group(group) => visit(group, tree, page, points)?,
            Node::Path(path) => flatten(path.data(), path.abs_transform(), tree, page),
            Node::Image(_) | Node::Text(_) => {}
        }
        *points += page.lines.last().map_or(0, |(line, _)| line.len());
        if *points > MOST_POINTS {
            return Err(format!("it has more than {MOST_POINTS} points"));
        }
    }
    Ok(())
}

/// Adds the subpaths of `path` to the page, curves cut into pieces.
fn flatten(path: &tiny_skia::Path, transform: Transform, tree: &Tree, page: &mut Page) {
    let size = tree.size();
    let place = |mut p: Point| {
        transform.map_point(&mut p);
        DVec2::new(f64::from(p.x) / f64::from(size.width()), 1.0 - f64::from(p.y) / f64::from(size.height()))
    };
    let mut line: Vec<DVec2> = Vec::new();
    let mut last = Point::zero();
    let mut end = |line: &mut Vec<DVec2>, is_closed: bool| {
        if !line.is_empty() {
            page.lines.push((std::mem::take(line), is_closed));
        }
    };
    for segment in path.segments() {
        match segment {
            PathSegment::MoveTo(p) => {
                end(&mut line, false);
                line.push(place(p));
                last = p;
            }
            PathSegment::LineTo(p) => {
                line.push(place(p));
                last = p;
            }
            PathSegment::QuadTo(a, p) => {
                let (from, a, to) = (place(last), place(a), place(p));
                line.extend((1..=PIECES).map(|i| {
                    let t = f64::from(i) / f64::from(PIECES);
                    let s = 1.0 - t;
                    from * (s * s) + a * (2.0 * s * t) + to * (t * t)
                }));
                last = p;
            }
            PathSegment::CubicTo(a, b, p) => {
                let (from, a, b, to) = (place(last), place(a), place(b), place(p));
                line.extend((1..=PIECES).map(|i| {
                    let t = f64::from(i) / f64::from(PIECES);
                    let s = 1.0 - t;
                    from * (s * s * s) + a * (3.0 * s * s * t) + b * (3.0 * s * t * t) + to * (t * t * t)
                }));
                last = p;
            }
            PathSegment::Close => {
                let first = line.first().copied();
                line.extend(first);
                end(&mut line, true);
            }
        }
    }
    end(&mut line, false);
}

/// Draws an SVG at its own size. `fonts` are font files that its texts may use.
///
/// # Errors
/// A sentence: no SVG, or too large.
pub fn draw_svg(svg: &str, fonts: &[&'static [u8]]) -> Result<Rgba, String> {
    let mut options = usvg::Options::default();
    for font in fonts {
        options.fontdb_mut().load_font_data(font.to_vec());
    }
    let tree = Tree::from_str(svg, &options).map_err(|e| e.to_string())?;
    let size = tree.size().to_int_size();
    let mut pixels = Pixmap::new(size.width(), size.height())
        .ok_or_else(|| format!("a picture of {} x {} is too large", size.width(), size.height()))?;
    resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
    Ok(Rgba {
        width: size.width(),
        height: size.height(),
        bytes: pixels
            .pixels()
            .iter()
            .flat_map(|p| {
                let c = p.demultiply();
                [c.red(), c.green(), c.blue(), c.alpha()]
            })
            .collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_strokes_and_points() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 50">
            <path d="M0 50L50 0" stroke="#000" fill="none"/><circle cx="75" cy="25" r="5"/></svg>"##;
        let page = decode_sketch(svg.as_bytes()).unwrap();
        assert_eq!(page.lines[0].0, [DVec2::ZERO, DVec2::new(0.5, 1.0)]);
        let points: Vec<_> = page.points().collect();
        assert!((points[1] - DVec2::new(0.75, 0.5)).length() < 1e-3, "{points:?}");
        assert!(decode_sketch(b"<svg xmlns='http://www.w3.org/2000/svg'/>").is_err());
        assert!(decode_sketch(b"\x89PNG").is_err());
    }
}
