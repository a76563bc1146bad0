//! Sketches, as SVG and as JSON; SVG: rasterisation of schematics, outlines of letters.

use resvg::tiny_skia::{self, PathSegment, Pixmap, Point, Transform};
use resvg::usvg::{self, Group, Node, Tree};
use serde::Deserialize;

use super::Rgba;
use crate::math::DVec2;

/// Line segments that approximate a Bezier curve.
const PIECES: u32 = 24;
/// Most points of a sketch.
const MOST_POINTS: usize = 1_000_000;

/// Why an SVG or a font is of no use.
#[derive(Debug, thiserror::Error)]
pub enum SketchError {
    /// It is not SVG.
    #[error("it is not an SVG picture: {0}")]
    Svg(usvg::Error),
    /// It is JSON of another kind.
    #[error(
        "it is no sketch in JSON, {{ \"size\": [width, height], \"strokes\": [[[x, y], ...], ...], \"points\": [[x, y], ...] }}: {0}"
    )]
    Json(serde_json::Error),
    /// It has a page without area, or a coordinate that is no finite number.
    #[error("its `size` and coordinates must be finite, and `size` above 0")]
    NotFinite,
    /// It has no paths.
    #[error("it has no paths")]
    NoPaths,
    /// It exceeds the limit.
    #[error("it has more than {MOST_POINTS} points")]
    TooManyPoints,
    /// It is not a font.
    #[error("it is not a TrueType or OpenType font")]
    Font,
    /// The text cannot be laid out.
    #[error("its letters cannot be set: {0}")]
    Layout(usvg::Error),
    /// The text has no visible glyph.
    #[error("it has no outlines for {0:?}")]
    NoOutlines(String),
    /// A schematic is not SVG.
    #[error(transparent)]
    Draw(usvg::Error),
    /// The pixels do not fit into memory.
    #[error("a picture of {0} x {1} is too large")]
    TooLarge(u32, u32),
}

/// The outlines of a sketch, in fractions of its page: x to the right, y up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Polylines, and whether each is closed.
    pub lines: Vec<(Vec<DVec2>, bool)>,
    /// The page's width over its height.
    pub aspect: f64,
}

impl Page {
    /// The centre of the bounding box of each closed outline, the end of each open one.
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

/// How SVG is read: its pictures are of no use to us, and their files are not opened.
fn options() -> usvg::Options<'static> {
    let images =
        usvg::ImageHrefResolver { resolve_data: Box::new(|_, _, _| None), resolve_string: Box::new(|_, _| None) };
    usvg::Options { image_href_resolver: images, ..usvg::Options::default() }
}

/// A sketch in JSON: in any unit, from the upper left corner of its page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Strokes {
    size: [f64; 2],
    #[serde(default)]
    strokes: Vec<Vec<[f64; 2]>>,
    #[serde(default)]
    points: Vec<[f64; 2]>,
}

/// Decodes a sketch in JSON. A stroke that ends where it began is closed.
fn decode_strokes(bytes: &[u8]) -> Result<Page, SketchError> {
    let Strokes { size: [width, height], strokes, points } =
        serde_json::from_slice(bytes).map_err(SketchError::Json)?;
    let page = |&[x, y]: &[f64; 2]| DVec2::new(x / width, 1.0 - y / height);
    let points = points.iter().map(|point| (vec![page(point)], false));
    let strokes = strokes.iter().filter(|stroke| !stroke.is_empty());
    let strokes = strokes.map(|stroke| {
        (stroke.iter().map(page).collect::<Vec<_>>(), stroke.len() > 2 && stroke.first() == stroke.last())
    });
    let lines: Vec<(Vec<DVec2>, bool)> = strokes.chain(points).collect();
    let is_finite = lines.iter().flat_map(|(line, _)| line).all(|p| p.is_finite());
    if lines.is_empty() {
        Err(SketchError::NoPaths)
    } else if lines.iter().map(|(line, _)| line.len()).sum::<usize>() > MOST_POINTS {
        Err(SketchError::TooManyPoints)
    } else if !(width > 0.0 && height > 0.0 && is_finite) {
        Err(SketchError::NotFinite)
    } else {
        Ok(Page { lines, aspect: width / height })
    }
}

/// Decodes the strokes and outlines of a sketch: SVG, or JSON (`{ "size": [width, height], "strokes": ..., "points": ... }`).
///
/// # Errors
/// [`SketchError`].
pub fn decode_sketch(bytes: &[u8]) -> Result<Page, SketchError> {
    if bytes.trim_ascii_start().starts_with(b"{") {
        return decode_strokes(bytes);
    }
    let tree = Tree::from_data(bytes, &options()).map_err(SketchError::Svg)?;
    let size = tree.size();
    let mut page = Page { lines: Vec::new(), aspect: f64::from(size.width()) / f64::from(size.height()) };
    let mut points = 0;
    visit(tree.root(), &tree, &mut page, &mut points)?;
    if page.lines.is_empty() {
        return Err(SketchError::NoPaths);
    }
    Ok(page)
}

/// Adds the paths of `group` to the page, and their points to the count.
fn visit(group: &Group, tree: &Tree, page: &mut Page, points: &mut usize) -> Result<(), SketchError> {
    for node in group.children() {
        match node {
            Node::Group(group) => visit(group, tree, page, points)?,
            Node::Path(path) => flatten(path.data(), path.abs_transform(), tree, page),
            Node::Image(_) | Node::Text(_) => {}
        }
        *points += page.lines.last().map_or(0, |(line, _)| line.len());
        if *points > MOST_POINTS {
            return Err(SketchError::TooManyPoints);
        }
    }
    Ok(())
}

/// Adds the subpaths of `path` to the page.
fn flatten(path: &tiny_skia::Path, transform: Transform, tree: &Tree, page: &mut Page) {
    let size = tree.size();
    subpaths(path, &mut page.lines, &|mut p: Point| {
        transform.map_point(&mut p);
        DVec2::new(f64::from(p.x) / f64::from(size.width()), 1.0 - f64::from(p.y) / f64::from(size.height()))
    });
}

/// Adds the subpaths of `path` as polylines, with points transformed by `place`.
fn subpaths(path: &tiny_skia::Path, lines: &mut Vec<(Vec<DVec2>, bool)>, place: &dyn Fn(Point) -> DVec2) {
    let mut line: Vec<DVec2> = Vec::new();
    let mut last = Point::zero();
    let mut end = |line: &mut Vec<DVec2>, is_closed: bool| {
        if !line.is_empty() {
            lines.push((std::mem::take(line), is_closed));
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

/// Font size at which letters are laid out, before scaling.
const EM: f64 = 1000.0;

/// The outlines of `text`, shaped with the font in `bytes` (TrueType or OpenType), line by line: an em of 1, the first baseline at
/// 0, x to the right, y up.
///
/// # Errors
/// [`SketchError::Font`], [`SketchError::Layout`], [`SketchError::NoOutlines`].
pub fn letter_outlines(text: &str, bytes: &[u8]) -> Result<Vec<Vec<DVec2>>, SketchError> {
    let mut options = options();
    options.fontdb_mut().load_font_data(bytes.to_vec());
    let family = options.fontdb.faces().find_map(|face| face.families.first().map(|(name, _)| name.clone()));
    let face = options.fontdb.faces().next().map(|face| (face.weight.0, face.style));
    let (Some(family), Some((weight, style))) = (family, face) else {
        return Err(SketchError::Font);
    };
    let style = match style {
        usvg::fontdb::Style::Normal => "normal",
        usvg::fontdb::Style::Italic => "italic",
        usvg::fontdb::Style::Oblique => "oblique",
    };
    let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    let rows: String = (0..)
        .zip(text.lines())
        .map(|(i, row): (u32, _)| {
            format!(r#"<text xml:space="preserve" x="0" y="{}">{}</text>"#, f64::from(i) * EM * LEADING, escaped(row))
        })
        .collect();
    let svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="1000" height="1000" font-family="{}" font-weight="{weight}" font-style="{style}" font-size="{EM}">{rows}</svg>"#,
        escaped(&family)
    );
    let tree = Tree::from_str(&svg, &options).map_err(SketchError::Layout)?;
    let mut lines = Vec::new();
    letters(tree.root(), &mut lines);
    if lines.is_empty() {
        return Err(SketchError::NoOutlines(text.to_owned()));
    }
    Ok(lines.into_iter().map(|(line, _)| line).collect())
}

/// Distance between baselines, in ems.
const LEADING: f64 = 1.2;

/// Adds the outlines of the glyphs in `group`.
fn letters(group: &Group, lines: &mut Vec<(Vec<DVec2>, bool)>) {
    for node in group.children() {
        match node {
            Node::Group(group) => letters(group, lines),
            Node::Path(path) => subpaths(path.data(), lines, &|mut p: Point| {
                path.abs_transform().map_point(&mut p);
                DVec2::new(f64::from(p.x), -f64::from(p.y)) / EM
            }),
            Node::Text(text) => letters(text.flattened(), lines),
            Node::Image(_) => {}
        }
    }
}

/// Rasterises an SVG at its own size. `fonts` are font files for its texts.
///
/// # Errors
/// [`SketchError::Draw`], [`SketchError::TooLarge`].
pub fn draw_svg(svg: &str, fonts: &[&'static [u8]]) -> Result<Rgba, SketchError> {
    let mut options = options();
    for font in fonts {
        options.fontdb_mut().load_font_data(font.to_vec());
    }
    let tree = Tree::from_str(svg, &options).map_err(SketchError::Draw)?;
    let size = tree.size().to_int_size();
    let mut pixels =
        Pixmap::new(size.width(), size.height()).ok_or(SketchError::TooLarge(size.width(), size.height()))?;
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

    #[test]
    fn reads_json() {
        let json = r#" { "size": [100, 50], "strokes": [[[0, 50], [50, 0]], [[10, 10], [30, 10], [10, 10]]], "points": [[75, 25]] }"#;
        let page = decode_sketch(json.as_bytes()).unwrap();
        assert_eq!(page.lines[0], (vec![DVec2::ZERO, DVec2::new(0.5, 1.0)], false));
        assert!(page.lines[1].1);
        let points: Vec<_> = page.points().collect();
        assert_eq!((points[0], points[2]), (DVec2::new(0.5, 1.0), DVec2::new(0.75, 0.5)));
        for (wrong, word) in [
            (r#"{ "size": [100, 50] }"#, "no paths"),
            (r#"{ "size": [0, 50], "points": [[1, 2]] }"#, "above 0"),
            (r#"{ "size": [1, 1], "points": [[1]] }"#, "line 1 column"),
            (r#"{ "size": [1, 1], "stroke": [] }"#, "unknown field"),
            ("{", "line 1"),
        ] {
            let said = decode_sketch(wrong.as_bytes()).unwrap_err().to_string();
            assert!(said.contains(word), "{said}");
        }
    }
}
