//! The command line as it is typed.

use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};

use crate::grow::MarkKind;
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
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make pictures of scenes
    Render(RenderArgs),
    /// Write scenes for other programs
    Export(ExportArgs),
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
    pub scenes: Vec<String>,
    /// Change a value of the scene, as in grow.elm.to.limbs.count=30
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
    /// Size of the picture in pixels, in place of the scene's own
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Most memory to take: bytes, or as 500M, 8G; three quarters of what the machine, its control group or its Slurm
    /// allocation has, by default
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    pub max_memory: Option<u64>,
}

#[derive(Debug, ClapArgs)]
#[command(group(clap::ArgGroup::new("how").required(true).args(["with", "schematic"])))]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The renderer
    #[arg(long, value_enum)]
    pub with: Option<Renderer>,
    /// Draw black strokes on white, as in the papers
    #[arg(long)]
    pub schematic: bool,
    /// Draw marks of the construction too
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MARKS", requires = "schematic")]
    pub show: Vec<Show>,
    /// Smooth edges
    #[arg(long, value_enum, default_value = "on", value_name = "WHEN", conflicts_with = "schematic")]
    pub antialias: Switch,
    /// Fill in the templates in this folder in place of the program's own
    #[arg(long, value_name = "DIR", conflicts_with = "schematic")]
    pub templates: Option<PathBuf>,
    /// The picture; {scene}, {seed} and what is swept stand for their values
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<String>,
    /// Make one labelled contact sheet of all pictures; without -o it is all that is written
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
    /// Leave out pictures that are there already
    #[arg(long)]
    pub skip_existing: bool,
}

#[derive(Debug, ClapArgs)]
pub struct ExportArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// What to write
    #[arg(long, value_enum)]
    pub to: Format,
    /// The folder to write to; {scene}, {seed} and what is swept stand for their values
    #[arg(long, short, value_name = "FOLDER", default_value = ".")]
    pub output: String,
    /// Name of the files and prefix of the names declared in them, in place of the scene's; patterns as in -o
    #[arg(long, value_name = "PREFIX")]
    pub name: Option<String>,
    /// Draw marks of the construction too (svg)
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MARKS")]
    pub show: Vec<Show>,
    /// Fill in the templates in this folder in place of the program's own (pov)
    #[arg(long, value_name = "DIR")]
    pub templates: Option<PathBuf>,
    /// Write over a .pov or .ini that was edited
    #[arg(long)]
    pub force: bool,
    /// Leave out exports that are there already
    #[arg(long)]
    pub skip_existing: bool,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Renderer {
    /// POV-Ray 3.7, which must be installed
    Povray,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// POV-Ray: NAME.inc, and NAME.pov with NAME.ini to show it off
    Pov,
    /// A schematic: NAME.svg
    Svg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    On,
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// A dot a node of the graph
    Nodes,
    /// A line an edge
    Edges,
    /// A ring an endpoint
    Endpoints,
    /// Outlines of spaces and of where endpoints are placed
    Shapes,
    /// Lines of equal path cost
    Contours,
}

impl From<Show> for MarkKind {
    fn from(show: Show) -> Self {
        match show {
            Show::Nodes => Self::Nodes,
            Show::Edges => Self::Edges,
            Show::Endpoints => Self::Endpoints,
            Show::Shapes => Self::Shapes,
            Show::Contours => Self::Contours,
        }
    }
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
