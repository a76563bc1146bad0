//! `strike`: lightning over a photograph, or over a sequence of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use rand::RngExt;

use super::args::{Seeds, StrikeArgs};
use super::choices::{PlateOrigin, PlateSpace};
use super::console::Console;
use super::error::Failure;
use super::guard::refuse_inputs;
use super::jobs::find_scene;
use super::memory;
use super::output::{self, is_stdout};
use super::place::{Place, Table, parse_place};
use super::preview::{depth, is_exr, is_png, pass_file, shine, write_shone};
use super::sheet::{Tile, write_sheet};
use super::{pattern, shown};
use crate::files::{ACESCG, Folder, REC709, Reads, decode_grey, decode_plate, set_chromaticities};
use crate::glow::Pass;
use crate::grow::Placement;
use crate::math::{DVec2, Memory, Stream};
use crate::model::BEYOND;
use crate::picture::Shone;
use crate::raster::{Grey, Plate, Samples};
use crate::scene::{self, Loaded, Override, Source};

/// No photograph has more bytes than this.
const MOST_BYTES: u64 = 2 << 30;

/// One photograph of a call, and what is made of it.
struct Shot {
    frame: Option<u32>,
    plate: PathBuf,
    outputs: Vec<PathBuf>,
}

pub fn run(args: &StrikeArgs, console: &Console) -> Result<(), Failure> {
    let reads = Reads::default();
    let source = find_scene(&args.scene, &args.limits, &reads, console)?;
    let seeds: Vec<Option<u64>> = match (&args.seeds, args.seed) {
        (Some(Seeds(seeds)), _) => seeds.iter().map(|&seed| Some(seed)).collect(),
        (None, seed) => vec![seed],
    };
    let shots = shots(args, seeds.len())?;
    let mut memory = memory::held(args.limits.max_memory);
    let track = args.track.as_ref().map(|path| Table::read(path, parse_place)).transpose()?;
    let number = |text: &str| match text.parse::<f64>() {
        Ok(x) if (0.0..1e6).contains(&x) => Ok(x),
        _ => Err("an intensity is a number from 0".to_owned()),
    };
    let intensity = args.intensity.as_ref().map(|path| Table::read(path, number)).transpose()?;
    let first = args.frames.as_ref().map_or(0, |frames| *frames.start());
    let struck_at = args.strike_at.unwrap_or(first);
    if let Some(frames) = args.frames.as_ref().filter(|frames| !frames.contains(&struck_at)) {
        console.note(&format!("note: it strikes at frame {struck_at}, outside {}-{}", frames.start(), frames.end()));
    }

    guard_inputs(args, &source, &reads, &shots, &seeds, console.json)?;

    let mut tiles = Vec::new();
    for shot in &shots {
        let plate = Arc::new(read_plate(&shot.plate, args.plate_space)?);
        let matte = args.matte.as_ref().map(|path| read_matte(path, &plate)).transpose()?.map(Arc::new);
        for &seed in &seeds {
            let begun = Instant::now();
            let what =
                args.track.as_ref().map_or("--to".to_owned(), |track| format!("a place in {}", shown::path(track)));
            let to = |place: &Place| place.resolve(plate.frame(), args.origin == PlateOrigin::BottomLeft, &what);
            let targets: Vec<[f64; 2]> = args.to.iter().map(to).collect::<Result<_, _>>()?;
            // Where the target is tracked the whole stroke goes with it, from where it is when it strikes.
            let place = |frame: f64| track.as_ref().map(|track: &Table<Place>| track.at(frame, between));
            let targets = match place(f64::from(struck_at)) {
                Some(place) => vec![to(&place)?],
                None => targets,
            };
            let shift = match (shot.frame, &track) {
                (Some(frame), Some(track)) => {
                    // It may leave the picture.
                    let now = track.at(f64::from(frame), between);
                    let now = now.fractions(plate.frame(), args.origin == PlateOrigin::BottomLeft);
                    [now[0] - targets[0][0], now[1] - targets[0][1]]
                }
                _ => [0.0; 2],
            };
            // Frame 1 of the scene's animation is the strike.
            let frame = shot.frame.map(|frame| f64::from(frame) - f64::from(struck_at) + 1.0);
            let mut resolved = load(args, &source, &plate, &targets, seed, frame)?;
            let Some(view) = &mut resolved.recipe.view else {
                return Err(Failure::Usage(format!(
                    "{} has no [view]: only such scenes strike photographs",
                    source.name
                )));
            };
            (view.plate, view.matte) = (Some(Arc::clone(&plate)), matte.clone());
            let label = seed.map_or_else(|| source.name.clone(), |seed| format!("seed {seed}"));
            let progress = console.progress(&label);
            let grown = scene::grow(&resolved, &[], &memory, &progress)?;
            let mut strokes = scene::model(&resolved, &grown, resolved.recipe.size, &memory, &progress)?.strokes;
            let told = match (&intensity, shot.frame) {
                (Some(table), Some(frame)) => table.at(f64::from(frame), |a, b, t| a + (b - a) * t),
                _ => 1.0,
            };
            let extent = resolved.recipe.view.as_ref().map_or([1.0; 2], |view| view.frame.extent);
            for stroke in &mut strokes {
                stroke.shift(DVec2::new(shift[0] * extent[0], shift[1] * extent[1]));
                stroke.glow.intensity *= told;
                stroke.glow.exposure = args.exposure.unwrap_or(stroke.glow.exposure);
            }
            let shone = shine(&resolved, &strokes, &memory, &progress)?;
            write(args, &shone, &resolved, shot, begun, &memory, console)?;
            if args.sheet.is_some() {
                let picture = shone.to_screen();
                memory = memory.beside(picture.bytes.len() as u64);
                tiles.push(Tile { picture, label });
            }
        }
    }
    console.done();
    if let Some(sheet) = &args.sheet {
        write_sheet(sheet, &tiles)?;
        output::tell(sheet, serde_json::Value::Null, console);
    }
    Ok(())
}

fn write(
    args: &StrikeArgs,
    shone: &Shone,
    scene: &Loaded,
    shot: &Shot,
    begun: Instant,
    memory: &Memory,
    console: &Console,
) -> Result<(), Failure> {
    let software = format!("lichtenberg {}", env!("CARGO_PKG_VERSION"));
    let document = scene.document().to_string();
    let texts = [("Title", scene.recipe.title.as_str()), ("Software", &software), ("Scene", &document)];
    for output in &shot.outputs {
        let path = with_seed(output, scene.recipe.seed);
        for file in write_shone(shone, &path, depth(&args.bits), args.split, &texts)? {
            let details = serde_json::json!({
                "seed": scene.recipe.seed,
                "frame": shot.frame,
                "size": scene.recipe.size,
                "seconds": begun.elapsed().as_secs_f64(),
                "memory": memory::told(memory),
            });
            output::tell(&file, details, console);
        }
    }
    Ok(())
}

/// What stands for the seed in names of outputs.
const SEED: &str = "{seed}";

/// `output` with the seed in its name.
fn with_seed(output: &Path, seed: u64) -> PathBuf {
    pattern::replace(output, SEED, &seed.to_string())
}

/// Refuses outputs that the call reads: photographs of any frame, mattes, tables, the scene and its files.
fn guard_inputs(
    args: &StrikeArgs,
    source: &Source,
    reads: &Reads,
    shots: &[Shot],
    seeds: &[Option<u64>],
    prints_json: bool,
) -> Result<(), Failure> {
    let own = scene::load_frame(source, &args.set, None)?.recipe.seed;
    let reads = reads.files();
    let others = [&args.matte, &args.track, &args.intensity].into_iter().flatten();
    let inputs = reads.iter().map(|read| &read.path).chain(shots.iter().map(|shot| &shot.plate)).chain(others);
    let mut outputs: Vec<PathBuf> = args.sheet.iter().cloned().collect();
    for (output, seed) in shots.iter().flat_map(|shot| &shot.outputs).flat_map(|o| seeds.iter().map(move |s| (o, s))) {
        let path = with_seed(output, seed.unwrap_or(own));
        if args.split {
            outputs.extend(Pass::ALL.map(|pass| pass_file(&path, pass)));
        }
        outputs.push(path);
    }
    output::check(&outputs, prints_json)?;
    refuse_inputs(inputs.map(PathBuf::as_path), &outputs)
}

/// What is read and what is written, all of it looked up before any of it is made.
fn shots(args: &StrikeArgs, seeds: usize) -> Result<Vec<Shot>, Failure> {
    for path in &args.output {
        let output = shown::path(path);
        if !is_png(path) && !is_exr(path) && !is_stdout(path) {
            return Err(Failure::Usage(format!("{output} must end in .png or .exr: that is what can be written")));
        }
        if args.split && !is_exr(path) {
            return Err(Failure::Usage(format!("--split writes OpenEXR, not {output}: end it in .exr")));
        }
        if seeds > 1 && !pattern::contains(path, SEED) {
            return Err(Failure::Usage(format!("{output} would be written {seeds} times: put {SEED} in its name")));
        }
    }
    if args.output.is_empty() && args.sheet.is_none() {
        return Err(Failure::Usage("say where the picture goes: -o FILE, or --sheet FILE".to_owned()));
    }
    let Some(frames) = &args.frames else {
        if pattern::contains(&args.plate, "#") && !args.plate.exists() {
            let plate = shown::path(&args.plate);
            return Err(Failure::Usage(format!("{plate} is a sequence: say which of it, as in --frames 1001-1012")));
        }
        return Ok(vec![Shot { frame: None, plate: args.plate.clone(), outputs: args.output.clone() }]);
    };
    let mut shots = Vec::new();
    for frame in frames.clone() {
        let fill = |path: &PathBuf| {
            pattern::number(path, frame).ok_or_else(|| {
                Failure::Usage(format!("{} needs #### where the frame's number goes", shown::path(path)))
            })
        };
        let outputs = args.output.iter().map(fill).collect::<Result<_, _>>()?;
        shots.push(Shot { frame: Some(frame), plate: fill(&args.plate)?, outputs });
    }
    let missing: Vec<String> =
        shots.iter().filter(|shot| !shot.plate.is_file()).map(|shot| shown::path(&shot.plate)).collect();
    if let Some(first) = missing.first() {
        return Err(Failure::Usage(format!("the sequence has gaps: {first} is missing, {} in all", missing.len())));
    }
    Ok(shots)
}

fn between(a: Place, b: Place, share: f64) -> Place {
    a.towards(b, share)
}

/// The scene with its stroke laid from where to where it is to go.
fn load(
    args: &StrikeArgs,
    source: &Source,
    plate: &Plate,
    targets: &[[f64; 2]],
    seed: Option<u64>,
    frame: Option<f64>,
) -> Result<Loaded, Failure> {
    let [width, height] = plate.frame();
    let mut overrides = args.set.clone();
    overrides.push(Override { path: "size".to_owned(), value: format!("[{width}, {height}]") });
    overrides.extend(seed.map(|seed| Override { path: "seed".to_owned(), value: seed.to_string() }));
    // What the scene is without the places, for its seed and its unit.
    let plain = scene::load_frame(source, &overrides, frame)?;
    let Some(view) = &plain.recipe.view else {
        return Err(Failure::Usage(format!("{} has no [view]: only such scenes strike photographs", source.name)));
    };
    let extent = view.frame.extent;
    let bolt = plain.recipe.steps.iter().find(|step| step.name == "bolt");
    if bolt.is_none_or(|bolt| bolt.endpoints.iter().all(|set| set.name != "target")) {
        return Err(Failure::Usage(format!(
            "{} has no step `bolt` with endpoints `target`: that is what is laid over a photograph",
            source.name
        )));
    }
    let horizon = args.horizon.as_ref().map(|y| {
        let place = parse_place(&format!("0,{y}")).map_err(Failure::Usage)?;
        place.resolve(plate.frame(), args.origin == PlateOrigin::BottomLeft, "--horizon").map(|[_, y]| y * extent[1])
    });
    let horizon = horizon.transpose()?;
    let low = horizon.unwrap_or(view.frame.horizon);
    if let Some(under) = targets.iter().find(|target| target[1] * extent[1] < low - 1e-9) {
        // As they were typed.
        let told = |up: f64| 100.0 * if args.origin == PlateOrigin::BottomLeft { up } else { 1.0 - up };
        return Err(Failure::Usage(format!(
            "--to lies below the horizon, where strokes end: it is at {:.0} % of the height, the horizon at {:.0} %",
            told(under[1]),
            told(low / extent[1])
        )));
    }
    let from: Vec<[f64; 2]> = if args.from.is_empty() {
        // From the top edge, a little to one side or the other.
        let mut random = Stream::new(plain.recipe.seed, "strike/from");
        targets
            .iter()
            .map(|target| {
                let aside: f64 = random.random_range(-0.25..0.25) * extent[1] / extent[0];
                // From beyond it, so that the stroke does not hang from the frame.
                [(target[0] + aside).clamp(0.02, 0.98), 1.0 + BEYOND * 0.6]
            })
            .collect()
    } else {
        let resolve = |place: &Place| place.resolve(plate.frame(), args.origin == PlateOrigin::BottomLeft, "--from");
        args.from.iter().map(resolve).collect::<Result<_, _>>()?
    };
    let points = |places: &[[f64; 2]]| {
        let point = |[x, y]: &[f64; 2]| format!("[{:?}, {:?}]", x * extent[0], y * extent[1]);
        format!("[{}]", places.iter().map(point).collect::<Vec<_>>().join(", "))
    };
    overrides.push(Override { path: "grow.bolt.from".to_owned(), value: format!("{{ at = {} }}", points(&from)) });
    overrides.push(Override { path: "grow.bolt.to.target.at".to_owned(), value: points(targets) });
    overrides.extend(horizon.map(|y| Override { path: "view.horizon".to_owned(), value: format!("{y:?}") }));
    let longest = |target: &[f64; 2]| {
        let way =
            |from: &[f64; 2]| DVec2::new((from[0] - target[0]) * extent[0] / extent[1], from[1] - target[1]).length();
        from.iter().map(way).fold(0.0, f64::max)
    };
    let length = targets.iter().map(longest).fold(0.0, f64::max);
    if length < 0.01 {
        return Err(Failure::Usage("--from and --to are the same place: a stroke needs some way to go".to_owned()));
    }
    let mut scene = scene::load_frame(source, &overrides, frame)?;
    // Side branches are those of a stroke as long as the picture is high; a shorter one has fewer and shorter ones.
    let share = length.min(1.0);
    for near in
        scene.recipe.steps.iter_mut().flat_map(|step| &mut step.endpoints).filter_map(|set| match &mut set.placement {
            Placement::Near(near) => Some(near),
            Placement::At(_) | Placement::Through(_) | Placement::Random(_) => None,
        })
    {
        near.count = (libm::round(f64::from(near.count) * libm::sqrt(share)) as u32).max(1);
        near.reach *= share;
    }
    Ok(scene)
}

/// A file, or one that the program carries with it: `skies/dusk-launch-pad.jpg`.
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let embedded = Folder::Embedded(PathBuf::new()).read(&path.to_string_lossy());
    if let (false, Ok(bytes)) = (path.exists(), embedded) {
        return Ok(bytes);
    }
    let size = fs::metadata(path).map_err(|e| Failure::file("read", path, &e))?.len();
    if size > MOST_BYTES {
        return Err(Failure::Usage(format!("{} has {size} bytes, {MOST_BYTES} at most are read", shown::path(path))));
    }
    fs::read(path).map_err(|e| Failure::file("read", path, &e))
}

fn read_plate(path: &Path, space: Option<PlateSpace>) -> Result<Plate, Failure> {
    let wrong = |error: String| Failure::Usage(format!("cannot strike {}: {error}", shown::path(path)));
    let mut plate = decode_plate(&read(path)?).map_err(|e| wrong(e.to_string()))?;
    let is_linear = matches!(plate.samples, Samples::Linear(_));
    match space {
        Some(_) if !is_linear => {
            return Err(wrong(
                "--plate-space is for linear photographs (OpenEXR); others say it in their profile".to_owned(),
            ));
        }
        Some(PlateSpace::Rec709) => set_chromaticities(&mut plate, REC709).map_err(|e| wrong(e.to_string()))?,
        Some(PlateSpace::Acescg) => set_chromaticities(&mut plate, ACESCG).map_err(|e| wrong(e.to_string()))?,
        None => {}
    }
    if plate.frame().iter().any(|&side| side < 16) {
        let [w, h] = plate.frame();
        return Err(wrong(format!("it has {w} by {h} pixels: too few to see a stroke in, 16 by 16 at least")));
    }
    Ok(plate)
}

fn read_matte(path: &Path, plate: &Plate) -> Result<Grey, Failure> {
    let wrong = |error: String| Failure::Usage(format!("{} is no matte here: {error}", shown::path(path)));
    let matte = decode_grey(&read(path)?).map_err(|e| wrong(e.to_string()))?;
    let ([w, h], [width, height]) = (matte.size(), plate.frame());
    if [w, h] != [width, height] {
        return Err(wrong(format!("it has {w} by {h} pixels, the photograph {width} by {height}")));
    }
    Ok(matte)
}
