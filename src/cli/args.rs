//! The command line as it is typed.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand};

use super::choices::{Format, Look, MetricName, PlateOrigin, PlateSpace, Quality, Renderer, Shadows, Show};
use super::place::{Place, parse_place};
use crate::scene::Override;

/// Grows branching natural things by least-cost paths through randomly weighted graphs, and hands them to renderers.
#[derive(Debug, Parser)]
#[command(name = "lichtenberg", version, max_term_width = 100)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
    /// No progress and no notes: results and errors only
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print results as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Threads to use; all cores by default. The result does not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// End, with exit code 124, if not done after so long
    #[arg(long, global = true, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub max_seconds: Option<u64>,
    /// Write no file with more bytes than this: a number, or as 500M, 8G (Unix)
    #[arg(long, global = true, value_name = "BYTES", value_parser = parse_bytes)]
    pub max_bytes: Option<u64>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make pictures of scenes
    Render(RenderArgs),
    /// Write scenes for other programs
    Export(ExportArgs),
    /// Strike lightning over a photograph, or over a sequence of them
    Strike(StrikeArgs),
    /// Tell whether pictures have changed: exit 0 the same, 1 different, 2 not comparable
    Compare(CompareArgs),
    /// List the embedded scenes
    List,
    /// Start a scene of your own: writes NAME.toml here, never over a file
    New(NewArgs),
    /// Find every mistake in scenes, without growing them
    Check(CheckArgs),
    /// Tell the numbers of a scene: nodes, edges, endpoints, primitives, bytes, seconds by stage
    Info(InfoArgs),
    /// Print the JSON Schema of scenes
    Schema(SchemaArgs),
    /// Print completions for a shell
    Completions(CompletionsArgs),
    /// Print the manual page
    Man,
}

/// What every command that grows scenes takes.
#[derive(Debug, ClapArgs)]
pub struct SceneArgs {
    /// Scene files, or names of embedded scenes (see `list`)
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Change a value of the scene, as in grow.elm.to.limbs.count=30, or grow.elm.from.at.0=[1,0,0]
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_override)]
    pub set: Vec<Override>,
    /// Seed of all random numbers, in place of the scene's own
    #[arg(long, value_name = "N", conflicts_with = "seeds")]
    pub seed: Option<u64>,
    /// Several seeds: 1-36, or 1,5,9
    #[arg(long, value_name = "LIST", value_parser = parse_seeds)]
    pub seeds: Option<Seeds>,
    /// Several values of one thing, as in space.air.weights.alpha=0.3,1,3
    #[arg(long, value_name = "PATH=A,B,...", value_parser = parse_sweep)]
    pub sweep: Vec<Sweep>,
    /// Frames of the scene's animation: 1-48, or one
    #[arg(long, value_name = "A-B", value_parser = parse_frames)]
    pub frames: Option<RangeInclusive<u32>>,
    /// Size of the picture in pixels, in place of the scene's own
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// What scenes may take and read.
#[derive(Debug, ClapArgs)]
pub struct LimitArgs {
    /// Most memory to take: bytes, or as 500M, 8G; three quarters of what the machine, its control group or its Slurm
    /// allocation has, by default
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    pub max_memory: Option<u64>,
    /// Let scenes read only what is below their own folder, wherever links lead: for scenes of strangers
    #[arg(long)]
    pub confined: bool,
    /// Let them read below this folder too
    #[arg(long, value_name = "DIR", requires = "confined")]
    pub allow: Vec<PathBuf>,
}

#[derive(Debug, ClapArgs)]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Render with an outside program in place of the built-in preview
    #[arg(long, value_enum)]
    pub with: Option<Renderer>,
    /// Draw black strokes on white, as in the papers
    #[arg(long, conflicts_with = "with")]
    pub schematic: bool,
    /// Show the picture in the terminal too; or, of a schematic, draw these marks of the construction
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MARKS", num_args = 0..=1, default_missing_value = "terminal")]
    pub show: Vec<Show>,
    /// How it is lit, in place of the scene's own look: studio has light from the whole sky and a soft sun, in natural that light
    /// goes on from surface to surface and through leaves, exact is POV-Ray's local light to the pixel; a scene that is drawn as a schematic (`show`) is traced with either
    #[arg(long, value_enum, conflicts_with = "schematic")]
    pub look: Option<Look>,
    /// Samples a pixel, 1 for its middle alone; 8 by default, at most in the natural look, and 9 in the exact one, where they are a
    /// square grid, and the middle
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), conflicts_with = "schematic")]
    pub samples: Option<u32>,
    /// In place of samples: draft has 2, good 8, final 64; in the natural look POV-Ray follows scattered light by it, too
    #[arg(long, value_enum, conflicts_with_all = ["samples", "schematic"])]
    pub quality: Option<Quality>,
    /// Render this part of the picture only: left, top, width, height in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop, conflicts_with = "schematic")]
    pub crop: Option<[u32; 4]>,
    /// Leave out the sky: alpha is what objects and the ground cover
    #[arg(long, conflicts_with_all = ["with", "schematic"])]
    pub transparent: bool,
    /// Bits a channel of a PNG
    #[arg(long, value_name = "BITS", value_parser = ["8", "16"], default_value = "8", conflicts_with_all = ["with", "schematic"])]
    pub bits: String,
    /// Fill in the templates in this folder in place of the program's own
    #[arg(long, value_name = "DIR", requires = "with")]
    pub templates: Option<PathBuf>,
    /// The picture, .png or .exr (with depth, normals, places, mattes, path cost and level), or - for PNG on standard
    /// output; {scene}, {seed} and what is swept stand for their values
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Make one labelled contact sheet of all pictures; without -o it is all that is written
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
    /// Leave out pictures that are there already
    #[arg(long)]
    pub skip_existing: bool,
    /// Render again whenever the scene's files change, coarse first, until interrupted
    #[arg(long, conflicts_with_all = ["sheet", "skip_existing", "seeds", "sweep", "frames"])]
    pub watch: bool,
}

#[derive(Debug, ClapArgs)]
pub struct ExportArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What to write
    #[arg(long, value_enum)]
    pub to: Format,
    /// The folder to write to, or - for standard output (svg, obj, ply); {scene}, {seed} and what is swept stand for
    /// their values
    #[arg(long, short, value_name = "FOLDER", default_value = ".")]
    pub output: PathBuf,
    /// Name of the files and prefix of the names declared in them, in place of the scene's; patterns as in -o
    #[arg(long, value_name = "PREFIX")]
    pub name: Option<String>,
    /// Draw marks of the construction too (svg)
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MARKS")]
    pub show: Vec<Show>,
    /// How the scene has its shadows (rib); maps by default
    #[arg(long, alias = "rib-shadows", value_enum)]
    pub shadows: Option<Shadows>,
    /// Leave thorns to a displacement shader, thorns.sl, which is written too and must be compiled (rib)
    #[arg(long)]
    pub displace: bool,
    /// How far limbs may be from their place, in pixels of the picture: what it is too coarse to show is left out; 0 by
    /// default, since others may come nearer to the archive (rib)
    #[arg(long, value_name = "PIXELS", value_parser = parse_amount)]
    pub detail: Option<f64>,
    /// Compress the archive of the objects, which RIB renderers read as it is (rib)
    #[arg(long)]
    pub gzip: bool,
    /// Fill in the templates in this folder in place of the program's own (pov, rib)
    #[arg(long, value_name = "DIR")]
    pub templates: Option<PathBuf>,
    /// Write over a .pov, .ini or .rib that was edited
    #[arg(long)]
    pub force: bool,
    /// Leave out exports that are there already
    #[arg(long)]
    pub skip_existing: bool,
}

#[derive(Debug, ClapArgs)]
pub struct StrikeArgs {
    /// The photograph: JPEG, PNG, TIFF, WebP or OpenEXR; plate.####.exr with --frames
    pub plate: PathBuf,
    /// Where it strikes: 2210,640px, 50%,30%, or fractions of width and height; several for several strokes, each from
    /// whichever start is cheapest
    #[arg(long, value_name = "X,Y", value_parser = parse_place, required_unless_present = "track")]
    pub to: Vec<Place>,
    /// Where it comes from; by default above the top edge, a little aside of each --to
    #[arg(long, value_name = "X,Y", value_parser = parse_place)]
    pub from: Vec<Place>,
    /// The corner that places count from
    #[arg(long, value_enum, default_value = "top-left")]
    pub origin: PlateOrigin,
    /// The scene that strikes: one with a [view] and a step `bolt` with endpoints `target`, as storm and night-bolt are
    #[arg(long, value_name = "SCENE", default_value = "storm")]
    pub scene: PathBuf,
    /// Change a value of the scene, as in object.bolt.glow.halo.strength=0.3
    #[arg(long, value_name = "PATH=VALUE", value_parser = parse_override)]
    pub set: Vec<Override>,
    /// Strength of the light in stops, in place of the scene's own
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    pub exposure: Option<f64>,
    /// Seed of all random numbers, in place of the scene's own
    #[arg(long, value_name = "N", conflicts_with = "seeds")]
    pub seed: Option<u64>,
    /// Several seeds, candidates to choose from: 1-36, or 1,5,9
    #[arg(long, value_name = "LIST", value_parser = parse_seeds, conflicts_with = "frames")]
    pub seeds: Option<Seeds>,
    /// A picture as large as the photograph, white where the foreground hides the stroke
    #[arg(long, value_name = "FILE")]
    pub matte: Option<PathBuf>,
    /// Height where strokes end at the latest, as the second of a place
    #[arg(long, value_name = "Y")]
    pub horizon: Option<String>,
    /// Colours of a linear photograph, in place of what it says itself
    #[arg(long, value_enum)]
    pub plate_space: Option<PlateSpace>,
    /// Frames of a sequence, the number standing for #### in its name
    #[arg(long, value_name = "A-B", value_parser = parse_frames)]
    pub frames: Option<RangeInclusive<u32>>,
    /// The frame of the strike, frame 1 of the scene's animation; by default the first
    #[arg(long, value_name = "FRAME", requires = "frames")]
    pub strike_at: Option<u32>,
    /// Where it strikes, by frame, in place of --to: a line `frame,x,y` each, x and y as there (1001,576px,397px); the
    /// whole stroke goes along
    #[arg(long, value_name = "FILE", requires = "frames", conflicts_with = "to")]
    pub track: Option<PathBuf>,
    /// Strength of the light by frame, times the scene's own: a line `frame,value` each
    #[arg(long, value_name = "FILE", requires = "frames")]
    pub intensity: Option<PathBuf>,
    /// The picture: .png as the photograph has it, .exr with passes that add up, or - for PNG on standard output; several
    /// for several formats; {seed} and #### stand for the seed and the frame
    #[arg(long, short, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// A file a pass, in place of one with all of them (.exr)
    #[arg(long)]
    pub split: bool,
    /// Bits a channel of a PNG made from a linear photograph
    #[arg(long, value_name = "BITS", value_parser = ["8", "16"], default_value = "8")]
    pub bits: String,
    /// Make one labelled contact sheet of all candidates
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}

#[derive(Debug, ClapArgs)]
pub struct CompareArgs {
    /// The expected picture, or a folder of them (.png, .exr)
    pub expected: PathBuf,
    /// The picture that is there, or a folder
    pub actual: PathBuf,
    /// What decides; all measures are printed
    #[arg(long, value_enum)]
    pub metric: Option<MetricName>,
    /// Pictures differ above this value of the metric; by default 0.01 (flip), 0.05 (flip-95), 0.1 (flip-max), 2/255
    /// (max), 0.002 (rms), 0.001 (share)
    #[arg(long, value_name = "X", value_parser = parse_amount)]
    pub threshold: Option<f64>,
    /// Compare these channels or layers of OpenEXR pictures, in place of R,G,B,A
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    pub channels: Vec<String>,
    /// Thresholds by file: metric, threshold, and [file."NAME"] with either; compare.toml in EXPECTED by default
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Write a JUnit report
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write a page with the pictures, failed ones first
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the differences as pictures to this folder
    #[arg(long, value_name = "DIR")]
    pub diff: Option<PathBuf>,
    /// Most memory to take: bytes, or as 500M, 8G; by default as for scenes
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    pub max_memory: Option<u64>,
    /// Accept different and new pictures as expected
    #[arg(long)]
    pub update: bool,
    /// Accept them even where CI=true
    #[arg(long, requires = "update")]
    pub force: bool,
}

#[derive(Debug, ClapArgs)]
pub struct NewArgs {
    /// Name of the new scene
    pub name: String,
    /// The embedded scene to start from; by default the one called NAME, or else `elm`
    #[arg(long, value_name = "SCENE")]
    pub like: Option<String>,
}

#[derive(Debug, ClapArgs)]
pub struct CheckArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Grow the scenes too, and hold them to what they claim
    #[arg(long)]
    pub claims: bool,
}

#[derive(Debug, ClapArgs)]
pub struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
}

#[derive(Debug, ClapArgs)]
pub struct SchemaArgs {
    /// Print the scene reference in Markdown in place of the schema
    #[arg(long)]
    pub markdown: bool,
}

#[derive(Debug, ClapArgs)]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// Seeds to go through, in order.
#[derive(Clone, Debug)]
pub struct Seeds(pub Vec<u64>);

/// Values of one thing to go through, in order.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Dotted path of keys.
    pub path: String,
    /// The values as TOML.
    pub values: Vec<String>,
}

/// More pictures than this in one call are a slip of the hand.
const MOST_JOBS: usize = 100_000;

fn parse_override(text: &str) -> Result<Override, String> {
    let (path, value) = text.split_once('=').ok_or("a change is PATH=VALUE, as in grow.elm.to.limbs.count=30")?;
    Ok(Override { path: path.trim().to_owned(), value: value.trim().to_owned() })
}

fn parse_seeds(text: &str) -> Result<Seeds, String> {
    let wrong = || format!("{text:?} is no list of seeds such as 1-36 or 1,5,9");
    let mut seeds = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let first: u64 = first.trim().parse().map_err(|_| wrong())?;
        let last: u64 = last.trim().parse().map_err(|_| wrong())?;
        if first > last || last - first >= MOST_JOBS as u64 || seeds.len() >= MOST_JOBS {
            return Err(wrong());
        }
        seeds.extend(first..=last);
    }
    Ok(Seeds(seeds))
}

fn parse_frames(text: &str) -> Result<RangeInclusive<u32>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let frame = |s: &str| s.trim().parse().ok().filter(|frame: &u32| *frame < 1 << 24);
    match (frame(first), frame(last)) {
        (Some(first), Some(last)) if first <= last && ((last - first) as usize) < MOST_JOBS => Ok(first..=last),
        _ => Err(format!("{text:?} are no frames such as 1-48")),
    }
}

fn parse_sweep(text: &str) -> Result<Sweep, String> {
    let change = parse_override(text)?;
    let mut values = vec![String::new()];
    let mut depth = 0;
    // Commas within brackets belong to a value.
    for c in change.value.chars() {
        match c {
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                values.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = values.last_mut() {
            last.push(c);
        }
    }
    Ok(Sweep { path: change.path, values: values.into_iter().map(|v| v.trim().to_owned()).collect() })
}

fn parse_amount(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("{text:?} is no number"))?;
    if value >= 0.0 && value.is_finite() { Ok(value) } else { Err("0 or more is wanted".to_owned()) }
}

fn parse_crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Vec<u32> = text.split(',').map_while(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, width, height] if width > 0 && height > 0 && text.split(',').count() == 4 => Ok([x, y, width, height]),
        _ => Err(format!("{text:?} is no part of a picture: left, top, width, height in pixels, as in 100,80,320,240")),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("{text:?} is no size from 16x16 to 16384x16384, such as 640x480");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let side = |s: &str| s.parse().ok().filter(|s| (16..=16384).contains(s)).ok_or_else(wrong);
    Ok([side(width)?, side(height)?])
}

fn parse_bytes(text: &str) -> Result<u64, String> {
    let (digits, factor) = match text.char_indices().last() {
        Some((at, 'k' | 'K')) => (&text[..at], 1 << 10),
        Some((at, 'm' | 'M')) => (&text[..at], 1 << 20),
        Some((at, 'g' | 'G')) => (&text[..at], 1 << 30),
        _ => (text, 1),
    };
    let number: u64 = digits.parse().map_err(|_| format!("{text:?} is no number of bytes such as 500M or 8G"))?;
    number.checked_mul(factor).ok_or_else(|| format!("{text:?} is more than any machine has"))
}
