//! What options choose from.

use clap::ValueEnum;

use crate::compare::Metric;
use crate::export::Rib;
use crate::geom::MarkKind;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Renderer {
    /// POV-Ray 3.7, which must be installed
    Povray,
    /// Pixie (`rndr`), which must be installed
    Pixie,
    /// Aqsis (`aqsis`), which must be installed
    Aqsis,
}

impl Renderer {
    /// What metadata call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Povray => "povray",
            Self::Pixie => "pixie",
            Self::Aqsis => "aqsis",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Shadows {
    /// No shadows, for speed
    None,
    /// Traced by the light `raydistant`, which Pixie has: sharper
    Rays,
    /// Maps that the scene makes first, which Pixie and Aqsis both read
    Maps,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// POV-Ray: NAME.inc, and NAME.pov with NAME.ini to show it off
    Pov,
    /// RenderMan: NAME.rib, and NAME.archive.rib with the objects
    Rib,
    /// A schematic: NAME.svg
    Svg,
    /// A mesh for other programs, y up: NAME.obj (objects with `skin = "mesh"`)
    Obj,
    /// A mesh for other programs, z up: NAME.ply (objects with `skin = "mesh"`)
    Ply,
}

impl Format {
    /// The files that it may make of a scene called `name`.
    pub fn files(self, name: &str) -> Vec<String> {
        let endings: &[&str] = match self {
            Self::Pov => &[".inc", "-stage.inc", ".pov", ".ini", "-sky.exr"],
            Self::Rib => &[".rib", ".archive.rib", ".casters.rib", ".stage.rib"],
            Self::Svg => &[".svg"],
            Self::Obj => &[".obj"],
            Self::Ply => &[".ply"],
        };
        let own = endings.iter().map(|ending| format!("{name}{ending}"));
        own.chain(Rib::shader_files().filter(|_| self == Self::Rib)).collect()
    }

    /// The ending of the file that it makes, or of the first of them.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Pov => "inc",
            Self::Rib => "rib",
            Self::Svg => "svg",
            Self::Obj => "obj",
            Self::Ply => "ply",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Look {
    /// Soft: light from the whole sky, a sun with a size, a filmic curve
    Studio,
    /// What POV-Ray shows, to the pixel: sharp shadows, constant ambient light
    Exact,
    /// The studio's lights, which go on from surface to surface and through leaves
    Natural,
}

impl Look {
    /// As the tracer calls it.
    pub fn traced(self) -> crate::model::Look {
        match self {
            Self::Studio => crate::model::Look::Studio,
            Self::Exact => crate::model::Look::Exact,
            Self::Natural => crate::model::Look::Natural,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// To try things
    Draft,
    /// To look at
    Good,
    /// To keep
    Final,
}

impl Quality {
    /// What metadata call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Good => "good",
            Self::Final => "final",
        }
    }

    /// Samples a pixel of our own preview, and of an outside renderer.
    pub fn samples(self) -> u32 {
        match self {
            Self::Draft => 2,
            Self::Good => 8,
            Self::Final => 64,
        }
    }

    /// What scenes of POV-Ray call it.
    pub fn level(self) -> u32 {
        self as u32
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// The picture, in the terminal
    Terminal,
    /// A dot a node of the graph
    Nodes,
    /// A line an edge
    Edges,
    /// A line an edge, the wider and darker the less it costs
    Costs,
    /// Where the sectors of a Yao graph in the plane meet
    Sectors,
    /// A ring an endpoint
    Endpoints,
    /// Outlines of spaces and of where endpoints are placed
    Shapes,
    /// Lines of equal path cost
    Contours,
}

impl Show {
    /// The mark that it names, if it names one.
    pub fn mark(self) -> Option<MarkKind> {
        match self {
            Self::Terminal => None,
            Self::Nodes => Some(MarkKind::Nodes),
            Self::Edges => Some(MarkKind::Edges),
            Self::Costs => Some(MarkKind::Costs),
            Self::Sectors => Some(MarkKind::Sectors),
            Self::Endpoints => Some(MarkKind::Endpoints),
            Self::Shapes => Some(MarkKind::Shapes),
            Self::Contours => Some(MarkKind::Contours),
        }
    }
}

/// A corner of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlateOrigin {
    /// Places count from the top, as in picture viewers
    TopLeft,
    /// Places count from the bottom, as in Nuke
    BottomLeft,
}

/// Colours of linear photographs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlateSpace {
    /// ITU-R BT.709, the primaries of sRGB
    Rec709,
    /// ACEScg (AP1)
    Acescg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MetricName {
    /// Mean FLIP
    Flip,
    /// The FLIP that 95 % of the pixels stay below
    #[value(name = "flip-95")]
    Flip95,
    /// The largest FLIP of any pixel (the default)
    FlipMax,
    /// Largest difference of a channel
    Max,
    /// Root-mean-square difference
    Rms,
    /// Share of pixels that differ by more than 2/255
    Share,
}

impl From<MetricName> for Metric {
    fn from(name: MetricName) -> Self {
        match name {
            MetricName::Flip => Self::Flip,
            MetricName::Flip95 => Self::Flip95,
            MetricName::FlipMax => Self::FlipMax,
            MetricName::Max => Self::Max,
            MetricName::Rms => Self::Rms,
            MetricName::Share => Self::Share,
        }
    }
}
