//! A small reader of RIB, for tests: it rebuilds what a renderer would see, and shares nothing with the exporter.

use std::collections::HashMap;

pub type Vec3 = [f64; 3];
/// Row vectors: `p' = p M`.
pub type Matrix = [[f64; 4]; 4];

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Word(String),
    Text(String),
    Number(f64),
    Open,
    Close,
}

/// A solid, in world space.
#[derive(Clone, Debug)]
pub enum Primitive {
    Sphere { centre: Vec3, radius: f64 },
    Frustum { a: Vec3, ra: f64, b: Vec3, rb: f64 },
    Polygons { points: Vec<Vec3>, normals: Vec<Vec3>, faces: Vec<Vec<usize>> },
}

#[derive(Clone, Debug, Default)]
pub struct Light {
    pub shader: String,
    pub parameters: HashMap<String, Vec<f64>>,
}

/// What a file says.
#[derive(Debug, Default)]
pub struct World {
    /// By the name of their attribute: surface shader, colour, primitives.
    pub objects: Vec<(String, String, Vec3, Vec<Primitive>)>,
    pub lights: Vec<Light>,
    /// From the world to the camera.
    pub camera: Matrix,
    pub projection: String,
    pub fov: f64,
    pub window: Vec<f64>,
    pub clipping: [f64; 2],
    pub format: [f64; 2],
}

pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn point(m: &Matrix, p: Vec3) -> Vec3 {
    std::array::from_fn(|j| p[0] * m[0][j] + p[1] * m[1][j] + p[2] * m[2][j] + m[3][j])
}

fn direction(m: &Matrix, p: Vec3) -> Vec3 {
    std::array::from_fn(|j| p[0] * m[0][j] + p[1] * m[1][j] + p[2] * m[2][j])
}

fn length(v: Vec3) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn tokens(text: &str) -> Vec<Token> {
    let mut found = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let mut rest = line;
        loop {
            rest = rest.trim_start();
            let Some(first) = rest.chars().next() else { break };
            match first {
                '[' | ']' => {
                    found.push(if first == '[' { Token::Open } else { Token::Close });
                    rest = &rest[1..];
                }
                '"' => {
                    let end = rest[1..].find('"').expect("a closed string") + 1;
                    found.push(Token::Text(rest[1..end].to_owned()));
                    rest = &rest[end + 1..];
                }
                _ => {
                    let end = rest.find(|c: char| c.is_whitespace() || c == '[' || c == ']').unwrap_or(rest.len());
                    let word = &rest[..end];
                    found.push(match word.parse::<f64>() {
                        Ok(number) => {
                            assert!(number.is_finite(), "{word}");
                            Token::Number(number)
                        }
                        Err(_) => Token::Word(word.to_owned()),
                    });
                    rest = &rest[end..];
                }
            }
        }
    }
    found
}

/// The arguments of a request: plain numbers and lists, in order, then named ones.
#[derive(Default)]
struct Arguments {
    numbers: Vec<f64>,
    lists: Vec<Vec<f64>>,
    texts: Vec<String>,
    named: HashMap<String, Vec<f64>>,
    named_texts: HashMap<String, String>,
}

fn arguments(tokens: &[Token]) -> Arguments {
    let mut found = Arguments::default();
    let mut i = 0;
    let mut name: Option<String> = None;
    while i < tokens.len() {
        match &tokens[i] {
            Token::Number(number) => found.numbers.push(*number),
            Token::Text(text) => {
                // A name goes before a list.
                if tokens.get(i + 1) == Some(&Token::Open) {
                    name = Some(text.clone());
                } else {
                    found.texts.push(text.clone());
                }
            }
            Token::Open => {
                let end = i + tokens[i..].iter().position(|t| *t == Token::Close).expect("a closed list");
                let numbers =
                    tokens[i + 1..end].iter().filter_map(|t| if let Token::Number(n) = t { Some(*n) } else { None });
                let numbers: Vec<f64> = numbers.collect();
                let text =
                    tokens[i + 1..end].iter().find_map(|t| if let Token::Text(t) = t { Some(t.clone()) } else { None });
                match name.take() {
                    Some(name) => {
                        if let Some(text) = text {
                            found.named_texts.insert(name.clone(), text);
                        }
                        found.named.insert(name, numbers);
                    }
                    None => found.lists.push(numbers),
                }
                i = end;
            }
            Token::Close | Token::Word(_) => panic!("unexpected {:?}", tokens[i]),
        }
        i += 1;
    }
    found
}

struct State {
    matrix: Matrix,
    name: String,
    surface: String,
    colour: Vec3,
}

impl Clone for State {
    fn clone(&self) -> Self {
        Self { matrix: self.matrix, name: self.name.clone(), surface: self.surface.clone(), colour: self.colour }
    }
}

/// Reads a scene; `archive` is what `ReadArchive` reads. Only the last frame counts.
pub fn read(text: &str, archive: &str) -> World {
    let mut world = World::default();
    let mut state = State { matrix: IDENTITY, name: String::new(), surface: String::new(), colour: [1.0; 3] };
    let mut stack: Vec<(State, &str)> = Vec::new();
    let mut retained: HashMap<u64, Vec<Primitive>> = HashMap::new();
    let mut recording: Option<(u64, State)> = None;
    let mut thirds: Vec<[Vec3; 2]> = Vec::new();
    let mut queue = tokens(text);
    queue.reverse();
    assert!(text.starts_with("##RenderMan RIB-Structure 1.1") && text.contains("\nversion 3.03\n"));
    while let Some(token) = queue.pop() {
        let Token::Word(request) = token else { panic!("expected a request, found {token:?}") };
        let mut taken = Vec::new();
        while queue.last().is_some_and(|t| !matches!(t, Token::Word(_))) {
            taken.extend(queue.pop());
        }
        let given = arguments(&taken);
        let all =
            || -> Vec<f64> { given.numbers.iter().copied().chain(given.lists.iter().flatten().copied()).collect() };
        let mut made: Option<Primitive> = None;
        match request.as_str() {
            "ReadArchive" => {
                let mut more = tokens(archive);
                more.reverse();
                queue.extend(more);
            }
            "FrameBegin" => world = World::default(),
            "WorldBegin" => {
                world.camera = state.matrix;
                stack.push((state.clone(), "World"));
                state.matrix = IDENTITY;
            }
            "AttributeBegin" | "TransformBegin" => {
                stack.push((state.clone(), if request.starts_with('A') { "Attribute" } else { "Transform" }));
            }
            "AttributeEnd" | "TransformEnd" | "WorldEnd" => {
                let (before, kind) = stack.pop().expect("a block to end");
                assert_eq!(format!("{kind}End"), request, "blocks end in order");
                state = match kind {
                    "Transform" => State { matrix: before.matrix, ..state },
                    _ => before,
                };
            }
            "FrameEnd" => state.matrix = IDENTITY,
            "ConcatTransform" => {
                let n = all();
                assert_eq!(n.len(), 16);
                let m: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| n[i * 4 + j]));
                state.matrix = times(&m, &state.matrix);
            }
            "Translate" => {
                let n = all();
                let mut m = IDENTITY;
                m[3] = [n[0], n[1], n[2], 1.0];
                state.matrix = times(&m, &state.matrix);
            }
            "Projection" => {
                world.projection = given.texts[0].clone();
                // Pixie refuses a type written before it.
                world.fov = given.named.get("fov").map_or(0.0, |fov| fov[0]);
            }
            "ScreenWindow" => world.window = all(),
            "Clipping" => world.clipping = [all()[0], all()[1]],
            "Format" => world.format = [all()[0], all()[1]],
            "LightSource" => {
                world.lights.push(Light { shader: given.texts[0].clone(), parameters: given.named.clone() });
            }
            "Attribute" => {
                if given.texts[0] == "identifier" {
                    state.name = given.named_texts["string name"].clone();
                    world.objects.push((state.name.clone(), String::new(), [0.0; 3], Vec::new()));
                }
            }
            "Color" => state.colour = [all()[0], all()[1], all()[2]],
            "Surface" => state.surface = given.texts[0].clone(),
            "ObjectBegin" => {
                recording = Some((all()[0] as u64, state.clone()));
                retained.insert(all()[0] as u64, Vec::new());
                state.matrix = IDENTITY;
            }
            "ObjectEnd" => state = recording.take().expect("an object to end").1,
            "ObjectInstance" => {
                let matrix = state.matrix;
                let object = world.objects.last_mut().expect("an object");
                (object.1, object.2) = (state.surface.clone(), state.colour);
                for primitive in retained[&(all()[0] as u64)].clone() {
                    object.3.push(moved(primitive, &matrix));
                }
            }
            "Sphere" => {
                let n = all();
                assert!(n[0] > 0.0 && n[1] == -n[0] && n[2] == n[0] && n[3] == 360.0, "{n:?}");
                made = Some(Primitive::Sphere { centre: [0.0; 3], radius: n[0] });
            }
            "Hyperboloid" => {
                let n = all();
                assert!(n.len() == 7 && n[6] == 120.0, "{n:?}");
                let ends = [[n[0], n[1], n[2]], [n[3], n[4], n[5]]];
                let [first, second] = ends.map(|[x, y, _]| length([x, y, 0.0]));
                assert!(first > 0.0 && first <= second * 1.001, "Pixie wants the narrower end first: {n:?}");
                thirds.push(ends);
                if let [one, two, three] = thirds[..] {
                    // Each is the one before turned by 120 degrees.
                    for (before, after) in [(one, two), (two, three)] {
                        for (b, a) in before.iter().zip(&after) {
                            let turned =
                                [-0.5 * b[0] - 0.75_f64.sqrt() * b[1], 0.75_f64.sqrt() * b[0] - 0.5 * b[1], b[2]];
                            let size = length(*b);
                            assert!(
                                turned.iter().zip(a).all(|(x, y)| (x - y).abs() < 1e-3 * size + 1e-5),
                                "{b:?} {a:?}"
                            );
                        }
                    }
                    thirds.clear();
                    // Its foot is where z is 0.
                    let [(za, ra), (zb, rb)] = if one[0][2] == 0.0 {
                        [(0.0, first), (one[1][2], second)]
                    } else {
                        [(0.0, second), (one[0][2], first)]
                    };
                    assert!(zb > 0.0, "{n:?}");
                    made = Some(Primitive::Frustum { a: [0.0, 0.0, za], ra, b: [0.0, 0.0, zb], rb });
                }
            }
            "Cone" => {
                let n = all();
                assert!(n.len() == 3 && n[0] > 0.0 && n[1] > 0.0 && n[2] == 360.0, "{n:?}");
                made = Some(Primitive::Frustum { a: [0.0; 3], ra: n[1], b: [0.0, 0.0, n[0]], rb: 0.0 });
            }
            "PointsPolygons" => {
                let triple = |list: &[f64]| -> Vec<Vec3> { list.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect() };
                let points = triple(&given.named["P"]);
                let mut at = 0;
                let faces: Vec<Vec<usize>> = given.lists[0]
                    .iter()
                    .map(|&count| {
                        let face = given.lists[1][at..at + count as usize].iter().map(|&i| i as usize).collect();
                        at += count as usize;
                        face
                    })
                    .collect();
                assert_eq!(at, given.lists[1].len());
                assert!(faces.iter().flatten().all(|&i| i < points.len()));
                let normals = given.named.get("N").map_or(Vec::new(), |list| triple(list));
                assert!(normals.is_empty() || normals.len() == points.len());
                assert!(given.named.get("Cs").is_none_or(|list| list.len() == points.len() * 3));
                made = Some(Primitive::Polygons { points, normals, faces });
            }
            "TextureCoordinates" => {
                let n = all();
                // How far along the limb, and how much of the pattern shows, at each corner.
                assert!(n.len() == 8 && n.chunks(2).all(|st| st == [n[0], n[1]]), "{n:?}");
                assert!(n[0] >= 0.0 && (0.0..=1.0).contains(&n[1]), "{n:?}");
            }
            "Atmosphere" => assert_eq!(given.texts[0], "fog", "a shader that every renderer has"),
            "Displacement" | "version" | "Option" | "Display" | "Quantize" | "Exposure" | "PixelSamples"
            | "PixelFilter" | "ShadingRate" | "DepthOfField" | "MakeShadow" => {}
            _ => panic!("{request} is not in the portable subset"),
        }
        if let Some(primitive) = made {
            let primitive = moved(primitive, &state.matrix);
            match &recording {
                Some((handle, _)) => retained.get_mut(handle).expect("an object").push(primitive),
                None => {
                    let object = world.objects.last_mut().expect("an object");
                    (object.1, object.2) = (state.surface.clone(), state.colour);
                    object.3.push(primitive);
                }
            }
        }
    }
    assert!(stack.is_empty(), "{} blocks do not end", stack.len());
    world
}

/// A primitive in another space; spheres and frusta need one that keeps angles.
fn moved(primitive: Primitive, m: &Matrix) -> Primitive {
    let scale = length(direction(m, [1.0, 0.0, 0.0]));
    match primitive {
        Primitive::Sphere { centre, radius } => Primitive::Sphere { centre: point(m, centre), radius: radius * scale },
        Primitive::Frustum { a, ra, b, rb } => {
            Primitive::Frustum { a: point(m, a), ra: ra * scale, b: point(m, b), rb: rb * scale }
        }
        Primitive::Polygons { points, normals, faces } => Primitive::Polygons {
            points: points.into_iter().map(|p| point(m, p)).collect(),
            normals: normals.into_iter().map(|n| direction(m, n)).collect(),
            faces,
        },
    }
}
