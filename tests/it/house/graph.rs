//! Who uses whom: edges between files, circles of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use super::modules::House;
use super::names::{Meaning, resolve};

/// From a file to a file: the lines and names that make the edge.
pub type Edges = BTreeMap<(usize, usize), BTreeSet<(usize, String)>>;

/// Every use of a name of another file. Imports that a file only hands on are no use of its own.
pub fn edges(house: &House) -> Edges {
    let mut found = Edges::new();
    let macros: BTreeMap<&str, usize> =
        house.modules.iter().flat_map(|m| m.macros.iter().map(|name| (name.as_str(), m.file))).collect();
    for (number, module) in house.modules.iter().enumerate() {
        let mut add = |line: usize, path: &[String]| {
            for meaning in resolve(house, number, path) {
                // An imported module is used where its names are.
                if let Meaning::Item(file) = meaning
                    && file != module.file
                {
                    found.entry((module.file, file)).or_default().insert((line, path.join("::")));
                }
            }
        };
        for used in &module.uses {
            if !used.is_public || module.words.contains(&used.alias) {
                add(used.line, &used.path);
            }
        }
        for (line, path) in &module.paths {
            let meanings = resolve(house, number, &path[..1]);
            // What was imported by its name is counted there.
            let is_item = meanings.iter().all(|m| matches!(m, Meaning::Item(_) | Meaning::Foreign));
            if !(is_item && module.uses.iter().any(|u| u.alias == path[0])) {
                add(*line, path);
            }
        }
        for (line, name) in &module.calls {
            if let Some(&file) = macros.get(name.as_str())
                && file != module.file
            {
                found.entry((module.file, file)).or_default().insert((*line, format!("{name}!")));
            }
        }
    }
    found
}

/// The strongly connected components of more than one file, the largest first.
pub fn circles(files: usize, edges: &Edges) -> Vec<Vec<usize>> {
    let mut ahead = vec![Vec::new(); files];
    for &(from, to) in edges.keys() {
        ahead[from].push(to);
    }
    let reached = |from: usize| {
        let mut seen = vec![false; files];
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            for &next in &ahead[at] {
                if !seen[next] {
                    seen[next] = true;
                    open.push(next);
                }
            }
        }
        seen
    };
    let reaches: Vec<Vec<bool>> = (0..files).map(reached).collect();
    let mut found = Vec::new();
    let mut taken = vec![false; files];
    for file in 0..files {
        if taken[file] || !reaches[file][file] {
            continue;
        }
        let circle: Vec<usize> = (0..files).filter(|&f| reaches[file][f] && reaches[f][file]).collect();
        for &f in &circle {
            taken[f] = true;
        }
        found.push(circle);
    }
    found.sort_by_key(|circle| std::cmp::Reverse(circle.len()));
    found
}

/// A circle's edges, one a line: from, to, and by which names.
pub fn told(house: &House, edges: &Edges, circle: &[usize]) -> String {
    let mut text = String::new();
    for (&(from, to), names) in edges {
        if circle.contains(&from) && circle.contains(&to) {
            let names: Vec<String> = names.iter().map(|(line, name)| format!("{name} (line {line})")).collect();
            let _ = writeln!(text, "  {} -> {}: {}", house.files[from], house.files[to], names.join(", "));
        }
    }
    text
}

/// Circles, globs and long functions, to be read.
pub fn report(house: &House) -> String {
    let edges = edges(house);
    let circles = circles(house.files.len(), &edges);
    let mut text = format!("{} files, {} edges, {} circles\n", house.files.len(), edges.len(), circles.len());
    for circle in &circles {
        let files: Vec<&str> = circle.iter().map(|&f| house.files[f].as_str()).collect();
        let _ = writeln!(text, "\n{} files: {}\n{}", circle.len(), files.join(", "), told(house, &edges, circle));
    }
    let mut long: Vec<_> = house.functions.iter().filter(|f| f.lines >= 60).collect();
    long.sort_by_key(|f| std::cmp::Reverse(f.lines));
    let _ = writeln!(text, "{} of {} functions have 60 lines or more:", long.len(), house.functions.len());
    for function in long {
        let _ = writeln!(
            text,
            "  {:>4} {}::{} (line {})",
            function.lines, house.files[function.file], function.name, function.line
        );
    }
    text
}
