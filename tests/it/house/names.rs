//! Which file a path means.

use std::collections::BTreeSet;

use super::modules::House;

/// What a name may stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Meaning {
    Module(usize),
    /// Defined in a file.
    Item(usize),
    /// Another crate's.
    Foreign,
}

type Meanings = BTreeSet<Meaning>;

/// A way through imports: which were followed.
type Trail = Vec<(usize, String)>;

/// What a path stands for, said in `module`; nothing if no name of it is known.
pub fn resolve(house: &House, module: usize, path: &[String]) -> Meanings {
    follow(house, module, path, &mut Vec::new())
}

fn follow(house: &House, module: usize, path: &[String], trail: &mut Trail) -> Meanings {
    let mut rest = path;
    let mut current = module;
    let mut is_absolute = false;
    while let Some((first, others)) = rest.split_first() {
        match first.as_str() {
            "crate" => current = 0,
            "self" => {}
            "super" => current = house.modules[current].parent.unwrap_or(0),
            _ => break,
        }
        is_absolute = true;
        rest = others;
    }
    let Some((first, others)) = rest.split_first() else { return Meanings::from([Meaning::Module(current)]) };
    let mut meanings = look_up(house, current, first, !others.is_empty(), trail);
    if meanings.is_empty() {
        // Made by a macro, or not ours.
        let unknown = if is_absolute { Meaning::Item(house.modules[current].file) } else { Meaning::Foreign };
        return Meanings::from([unknown]);
    }
    for (i, name) in others.iter().enumerate() {
        let modules: Vec<usize> =
            meanings.iter().filter_map(|m| if let Meaning::Module(m) = m { Some(*m) } else { None }).collect();
        // A type's own names are where the type is.
        let Some(&inner) = modules.first() else { break };
        meanings = look_up(house, inner, name, i + 1 < others.len(), trail);
        if meanings.is_empty() {
            return Meanings::from([Meaning::Item(house.modules[inner].file)]);
        }
    }
    meanings
}

/// What a name stands for in a module. If it `goes_on`, more names follow: a module is meant before what is called like it.
fn look_up(house: &House, module: usize, name: &str, goes_on: bool, trail: &mut Trail) -> Meanings {
    let child = house.modules[module].children.get(name).map(|&child| Meaning::Module(child));
    if goes_on && let Some(child) = child {
        return Meanings::from([child]);
    }
    let mut found = Meanings::new();
    if trail.iter().any(|(m, n)| *m == module && n == name) {
        return found;
    }
    trail.push((module, name.to_owned()));
    let here = &house.modules[module];
    found.extend(child);
    if here.defined.contains(name) || here.macros.contains(name) {
        found.insert(Meaning::Item(here.file));
    }
    for used in here.uses.iter().filter(|u| u.alias == name) {
        found.extend(follow(house, module, &used.path, trail));
    }
    if found.is_empty() {
        for used in here.uses.iter().filter(|u| u.alias == "*") {
            for meaning in follow(house, module, &used.path, trail) {
                match meaning {
                    Meaning::Module(inner) => found.extend(look_up(house, inner, name, false, trail)),
                    // An enum's variants cannot be told from other names.
                    Meaning::Item(_) | Meaning::Foreign => {}
                }
            }
        }
    }
    trail.pop();
    found
}
