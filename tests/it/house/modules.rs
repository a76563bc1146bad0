//! The modules of a crate: what each defines, imports and names, without its tests.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::tokens::{Kind, Token, tokens};

/// A crate's modules and files, by number. Module 0 is the root.
#[derive(Debug, Default)]
pub struct House {
    pub modules: Vec<Module>,
    /// Paths below the folder that was read, as `grow/mod.rs`.
    pub files: Vec<String>,
    pub functions: Vec<Function>,
}

#[derive(Debug, Default)]
pub struct Module {
    pub parent: Option<usize>,
    pub file: usize,
    pub children: BTreeMap<String, usize>,
    pub defined: BTreeSet<String>,
    pub macros: BTreeSet<String>,
    pub uses: Vec<Use>,
    /// Paths in its code of two names or more, with their lines.
    pub paths: Vec<(usize, Vec<String>)>,
    /// Every name in its code outside of imports.
    pub words: BTreeSet<String>,
    /// Macros that its code calls, with their lines.
    pub calls: Vec<(usize, String)>,
}

/// One name of a `use`.
#[derive(Debug, Clone)]
pub struct Use {
    pub line: usize,
    pub path: Vec<String>,
    /// What it is called here; `*` for all.
    pub alias: String,
    pub is_public: bool,
}

#[derive(Debug, Clone)]
pub struct Function {
    pub file: usize,
    pub name: String,
    pub line: usize,
    /// From its signature to its last brace.
    pub lines: usize,
}

impl House {
    /// Reads the crate whose root is `lib.rs` of `folder`.
    pub fn read(folder: &Path) -> Self {
        let mut house = Self::default();
        house.read_file(folder, Path::new("lib.rs"), None);
        house
    }

    fn read_file(&mut self, folder: &Path, path: &Path, parent: Option<usize>) -> usize {
        let text = fs::read_to_string(folder.join(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        self.files.push(path.to_string_lossy().into_owned());
        let file = self.files.len() - 1;
        let module = self.add(parent, file);
        let tokens = tokens(&text);
        let children = Parser { house: self, file, tokens: &tokens, at: 0 }.module(module);
        let is_root = path.file_name().is_some_and(|n| n == "mod.rs" || n == "lib.rs");
        let below = if is_root { path.parent().unwrap_or(Path::new("")).to_owned() } else { path.with_extension("") };
        for (owner, name, given) in children {
            let flat = below.join(format!("{name}.rs"));
            let child = match given {
                Some(given) => path.parent().unwrap_or(Path::new("")).join(given),
                None if folder.join(&flat).is_file() => flat,
                None => below.join(&name).join("mod.rs"),
            };
            let number = self.read_file(folder, &child, Some(owner));
            self.modules[owner].children.insert(name, number);
        }
        module
    }

    fn add(&mut self, parent: Option<usize>, file: usize) -> usize {
        self.modules.push(Module { parent, file, ..Module::default() });
        self.modules.len() - 1
    }
}

/// A module in another file: whose child, its name, the path given by an attribute.
type Child = (usize, String, Option<PathBuf>);

struct Parser<'a> {
    house: &'a mut House,
    file: usize,
    tokens: &'a [Token],
    at: usize,
}

impl Parser<'_> {
    fn here(&mut self, module: usize) -> &mut Module {
        &mut self.house.modules[module]
    }

    fn token(&self, ahead: usize) -> Option<&Token> {
        self.tokens.get(self.at + ahead)
    }

    fn mark(&self, ahead: usize, mark: char) -> bool {
        self.token(ahead).is_some_and(|t| t.is(mark))
    }

    /// Reads to the end of the module; its children in other files are returned.
    fn module(&mut self, module: usize) -> Vec<Child> {
        let mut children = Vec::new();
        let mut depth = 0_usize;
        let mut attributes = Attributes::default();
        let mut is_public = false;
        while let Some(token) = self.token(0) {
            let line = token.line;
            if token.is('#') && (self.mark(1, '[') || (self.mark(1, '!') && self.mark(2, '['))) {
                self.attribute(module, &mut attributes);
                continue;
            }
            if attributes.is_test {
                self.skip_item();
                attributes = Attributes::default();
                continue;
            }
            let name = token.name().map(str::to_owned);
            match (&token.kind, name.as_deref()) {
                (Kind::Mark('{'), _) => depth += 1,
                (Kind::Mark('}'), _) if depth == 0 => return children,
                (Kind::Mark('}'), _) => depth -= 1,
                (_, Some("pub")) => {
                    is_public = true;
                    self.at += 1;
                    if self.mark(0, '(') {
                        self.skip_group();
                    }
                    continue;
                }
                (_, Some("use")) => {
                    self.at += 1;
                    self.use_tree(module, line, is_public, Vec::new());
                }
                (_, Some("mod")) if depth == 0 => {
                    let name = self.token(1).and_then(Token::name).unwrap_or_default().to_owned();
                    self.at += 2;
                    if self.mark(0, '{') {
                        self.at += 1;
                        let inner = self.house.add(Some(module), self.file);
                        self.here(module).children.insert(name, inner);
                        children.extend(self.module(inner));
                    } else {
                        children.push((module, name, attributes.path.take()));
                    }
                }
                (_, Some("macro_rules")) if self.mark(1, '!') => {
                    let name = self.token(2).and_then(Token::name).unwrap_or_default().to_owned();
                    self.here(module).macros.insert(name);
                    self.at += 3;
                    self.skip_group();
                    continue;
                }
                (_, Some(_)) => {
                    self.word(module, depth);
                    attributes = Attributes::default();
                    is_public = false;
                    continue;
                }
                _ => {}
            }
            attributes = Attributes::default();
            is_public = false;
            self.at += 1;
        }
        children
    }

    /// A keyword or name of code: a definition, a path, a macro's call, or a mere word.
    fn word(&mut self, module: usize, depth: usize) {
        let line = self.tokens[self.at].line;
        let word = self.tokens[self.at].name().unwrap_or_default().to_owned();
        let next = self.token(1).and_then(Token::name).map(str::to_owned);
        if word == "fn" && next.is_some() {
            self.function(line);
        }
        if depth == 0 && matches!(&*word, "struct" | "enum" | "union" | "trait" | "type" | "const" | "static" | "fn") {
            let skipped = ["mut", "unsafe", "extern", "async"];
            if let Some(name) = next.filter(|n| !skipped.contains(&n.as_str()) && n != "fn") {
                self.here(module).defined.insert(name);
                self.at += 2;
                return;
            }
        }
        let before = self.at.checked_sub(1).map(|i| &self.tokens[i]);
        let is_after_dot =
            before.is_some_and(|t| t.is('.')) && !self.at.checked_sub(2).is_some_and(|i| self.tokens[i].is('.'));
        if self.mark(1, '!') && !self.mark(2, '=') {
            self.here(module).calls.push((line, word.clone()));
        }
        let mut path = vec![word];
        self.at += 1;
        while self.token(0).is_some_and(|t| t.kind == Kind::Path)
            && let Some(next) = self.token(1).and_then(Token::name)
        {
            path.push(next.to_owned());
            self.at += 2;
        }
        if is_after_dot {
            return;
        }
        self.here(module).words.insert(path[0].clone());
        if path.len() > 1 {
            self.here(module).paths.push((line, path));
        }
    }

    /// Notes how long the function is that begins here; nothing is skipped.
    fn function(&mut self, line: usize) {
        let name = self.token(1).and_then(Token::name).unwrap_or_default().to_owned();
        let mut depth = 0;
        let mut body = None;
        for token in &self.tokens[self.at..] {
            match token.kind {
                Kind::Mark('(' | '[') => depth += 1,
                Kind::Mark(')' | ']') => depth -= 1,
                Kind::Mark('{') => {
                    body.get_or_insert(depth);
                    depth += 1;
                }
                Kind::Mark('}') => {
                    depth -= 1;
                    if body == Some(depth) {
                        let lines = token.line - line + 1;
                        self.house.functions.push(Function { file: self.file, name, line, lines });
                        return;
                    }
                }
                // A trait's function without a body.
                Kind::Mark(';') if depth == 0 && body.is_none() => return,
                _ => {}
            }
        }
    }

    fn attribute(&mut self, module: usize, attributes: &mut Attributes) {
        let line = self.tokens[self.at].line;
        self.at += if self.mark(1, '!') { 2 } else { 1 };
        let begun = self.at;
        self.skip_group();
        let inside = &self.tokens[begun..self.at];
        let names: Vec<&str> = inside.iter().filter_map(Token::name).collect();
        if names.first() == Some(&"cfg") && names.contains(&"test") && !names.contains(&"not") {
            attributes.is_test = true;
        }
        for token in inside {
            let Kind::Text(text) = &token.kind else { continue };
            if names.first() == Some(&"path") {
                attributes.path = Some(PathBuf::from(text));
            }
            // serde names functions in strings.
            let path: Vec<String> = text.split("::").map(str::to_owned).collect();
            let is_name = |n: &String| !n.is_empty() && n.chars().all(|c| c.is_alphanumeric() || c == '_');
            if path.len() > 1 && path.iter().all(is_name) {
                self.here(module).paths.push((line, path));
            }
        }
    }

    /// Past the group that begins here.
    fn skip_group(&mut self) {
        let mut depth = 0;
        while let Some(token) = self.token(0) {
            match token.kind {
                Kind::Mark('(' | '[' | '{') => depth += 1,
                Kind::Mark(')' | ']' | '}') => depth -= 1,
                _ => {}
            }
            self.at += 1;
            if depth == 0 {
                return;
            }
        }
    }

    /// Past the item that begins here: its semicolon, or its block.
    fn skip_item(&mut self) {
        let is_use = self.tokens[self.at..].iter().take(3).any(|t| t.is_name("use"));
        while let Some(token) = self.token(0) {
            match token.kind {
                Kind::Mark(';') => {
                    self.at += 1;
                    return;
                }
                Kind::Mark('{') => {
                    self.skip_group();
                    if !is_use {
                        return;
                    }
                }
                Kind::Mark('(' | '[') => self.skip_group(),
                _ => self.at += 1,
            }
        }
    }

    /// One branch of a `use`, from here to its comma, brace or semicolon.
    fn use_tree(&mut self, module: usize, line: usize, is_public: bool, mut path: Vec<String>) {
        loop {
            let Some(token) = self.token(0) else { return };
            match &token.kind {
                Kind::Name(name) if name == "as" => {
                    let alias = self.token(1).and_then(Token::name).unwrap_or("_").to_owned();
                    self.at += 2;
                    self.here(module).uses.push(Use { line, path, alias, is_public });
                    return;
                }
                Kind::Name(name) => path.push(name.clone()),
                Kind::Mark('*') => {
                    self.at += 1;
                    self.here(module).uses.push(Use { line, path, alias: "*".to_owned(), is_public });
                    return;
                }
                Kind::Mark('{') => {
                    self.at += 1;
                    while !self.mark(0, '}') {
                        self.use_tree(module, line, is_public, path.clone());
                        if self.mark(0, ',') {
                            self.at += 1;
                        }
                    }
                    self.at += 1;
                    return;
                }
                Kind::Path => {}
                _ => {
                    // `a::{self}` is `a`.
                    if path.len() > 1 && path.last().is_some_and(|n| n == "self") {
                        path.pop();
                    }
                    let Some(alias) = path.last().cloned() else { return };
                    self.here(module).uses.push(Use { line, path, alias, is_public });
                    return;
                }
            }
            self.at += 1;
        }
    }
}

#[derive(Debug, Default)]
struct Attributes {
    is_test: bool,
    path: Option<PathBuf>,
}
