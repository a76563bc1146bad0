//! docs/papers.md, which tells of every figure what it shows, what is claimed and measured, and what differs.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;

use lichtenberg::scene::Finding;

use crate::support::{embedded, root, scene_names};

/// The papers' scenes.
pub fn papers() -> Vec<String> {
    scene_names().into_iter().filter(|name| name.starts_with("papers/")).collect()
}

/// What was measured of a claim over several seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    least: f64,
    most: f64,
    /// The value with the least margin, and what it was held against.
    worst: String,
}

impl Measured {
    /// Of the findings of one claim.
    pub fn of(findings: &[&Finding]) -> Self {
        let values = || findings.iter().map(|finding| finding.measured);
        let worst = findings.iter().min_by(|a, b| a.margin.total_cmp(&b.margin)).unwrap();
        Self {
            least: values().fold(f64::INFINITY, f64::min),
            most: values().fold(f64::NEG_INFINITY, f64::max),
            worst: format!("{}: {}", short(worst.measured), worst.against),
        }
    }

    /// Is `value` among what was measured?
    pub fn holds(&self, value: f64) -> bool {
        (self.least..=self.most).contains(&value)
    }
}

/// A number with some four digits.
fn short(x: f64) -> String {
    let digits = if x == x.trunc() { 0 } else { (3 - libm::floor(libm::log10(x.abs().max(1e-3))) as i32).clamp(0, 4) };
    format!("{x:.*}", digits as usize)
}

/// What was measured of every claim of the papers' scenes, by scene and claim; beside the scenes.
pub fn measured() -> BTreeMap<(String, String), Measured> {
    let row = |line: &str| {
        let [scene, claim, least, most, worst] = line.split('\t').collect::<Vec<_>>()[..] else { panic!("{line:?}") };
        let measured = Measured { least: least.parse().unwrap(), most: most.parse().unwrap(), worst: worst.to_owned() };
        ((format!("papers/{scene}"), claim.to_owned()), measured)
    };
    read("scenes/papers/measured.tsv").lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

/// Keeps what was measured.
pub fn keep(all: &BTreeMap<(String, String), Measured>) {
    let mut text = "# scene	claim	least and greatest of seeds 1 to 8	nearest to failing\n".to_owned();
    for ((scene, claim), Measured { least, most, worst }) in all {
        let scene = scene.trim_start_matches("papers/");
        writeln!(text, "{scene}\t{claim}\t{least}\t{most}\t{worst}").unwrap();
    }
    fs::write(root().join("scenes/papers/measured.tsv"), text).unwrap();
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The papers by the beginning of their scenes' names.
const PAPERS: [(&str, &str); 4] = [
    ("2007-", "Xu and Mould 2007, modeling dendritic shapes using path planning"),
    ("2008-", "Xu and Mould 2008, constructive path planning for natural phenomena modeling"),
    ("2012-", "Xu and Mould 2012, synthetic tree models from iterated discrete graphs"),
    ("amin-", "Amin, the Growth module of voxel space automata"),
];

/// The rows of all figures.
fn figures() -> String {
    let (measured, differs) = (measured(), read("scenes/papers/differs.tsv"));
    let differs: BTreeMap<&str, &str> =
        differs.lines().filter(|line| !line.starts_with('#')).map(|line| line.split_once('\t').unwrap()).collect();
    assert_eq!(differs.len(), papers().len(), "scenes/papers/differs.tsv has a row for every scene");
    let mut text = String::new();
    for (start, paper) in PAPERS {
        write!(text, "\n## {paper}\n\n| figure | it shows | it claims: least to greatest of seeds 1 to 8, and nearest to failing | what differs |\n|---|---|---|---|\n").unwrap();
        for name in papers().iter().filter(|name| name["papers/".len()..].starts_with(start)) {
            let scene = embedded(name, &[]);
            let file = &name["papers/".len()..];
            let figure = scene.recipe.title.split_once(", ").map_or("", |(_, rest)| rest);
            let figure = if start == "amin-" {
                figure
            } else {
                figure.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start_matches(", ")
            };
            let claims = scene.claims.iter().map(|(claim, claimed)| {
                let Measured { least, most, worst } = measured
                    .get(&(name.clone(), claim.clone()))
                    .unwrap_or_else(|| panic!("{name}: {claim} is not in scenes/papers/measured.tsv"));
                let range =
                    if least == most { short(*least) } else { format!("{} to {}", short(*least), short(*most)) };
                format!("{}: **{range}** ({worst})", claimed.claim.says)
            });
            writeln!(
                text,
                "| <img src=\"../renders/gallery/papers-{file}.webp\" width=\"240\"><br>{figure} ([scene](../scenes/papers/{file}.toml)) | {} | {} | {} |",
                scene.document()["about"].as_str().unwrap_or_default(),
                claims.collect::<Vec<_>>().join("<br>"),
                differs[file]
            )
            .unwrap();
        }
    }
    text
}

/// Between these lines the page is made by this test.
const MADE: [&str; 2] = ["<!-- made by UPDATE=1 cargo test --test it papers:: -->\n", "\n<!-- end of what is made -->"];

#[test]
fn the_page_of_figures_is_current() {
    let page = read("docs/papers.md");
    let (head, rest) = page.split_once(MADE[0]).expect("docs/papers.md has the line that begins what is made");
    let (made, tail) = rest.split_once(MADE[1]).expect("docs/papers.md has the line that ends what is made");
    let figures = figures();
    if std::env::var_os("UPDATE").is_some() {
        fs::write(root().join("docs/papers.md"), [head, MADE[0], &figures, MADE[1], tail].concat()).unwrap();
    } else {
        assert!(made == figures, "docs/papers.md is stale: UPDATE=1 ./run-tests --claims, or what its first line says");
    }
}
