//! Rust source as tokens: no comments, no white space.

/// A token, and the line it begins in, from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    pub line: usize,
    pub kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// Names and keywords; `r#` is left out.
    Name(String),
    /// What a string holds, escapes as written.
    Text(String),
    /// One character; `::` is one token, as `:`.
    Mark(char),
    /// `::`.
    Path,
    /// Numbers, characters and lifetimes.
    Other,
}

impl Token {
    pub fn is(&self, mark: char) -> bool {
        self.kind == Kind::Mark(mark)
    }

    pub fn name(&self) -> Option<&str> {
        match &self.kind {
            Kind::Name(name) => Some(name),
            _ => None,
        }
    }

    pub fn is_name(&self, name: &str) -> bool {
        self.name() == Some(name)
    }
}

/// The tokens of a source text.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut reader = Reader { chars: text.chars().collect(), at: 0, line: 1 };
    let mut found = Vec::new();
    loop {
        reader.skip_blanks();
        let line = reader.line;
        let Some(kind) = reader.token() else { return found };
        found.push(Token { line, kind });
    }
}

struct Reader {
    chars: Vec<char>,
    at: usize,
    line: usize,
}

impl Reader {
    fn peek(&self, ahead: usize) -> char {
        self.chars.get(self.at + ahead).copied().unwrap_or('\0')
    }

    fn step(&mut self, count: usize) {
        for _ in 0..count {
            if self.peek(0) == '\n' {
                self.line += 1;
            }
            self.at += 1;
        }
    }

    fn ended(&self) -> bool {
        self.at >= self.chars.len()
    }

    fn skip_blanks(&mut self) {
        loop {
            if self.peek(0).is_whitespace() {
                self.step(1);
            } else if self.peek(0) == '/' && self.peek(1) == '/' {
                while !self.ended() && self.peek(0) != '\n' {
                    self.step(1);
                }
            } else if self.peek(0) == '/' && self.peek(1) == '*' {
                let mut depth = 0;
                loop {
                    match (self.peek(0), self.peek(1)) {
                        ('/', '*') => depth += 1,
                        ('*', '/') => depth -= 1,
                        _ => {
                            self.step(1);
                            continue;
                        }
                    }
                    self.step(2);
                    if depth == 0 || self.ended() {
                        break;
                    }
                }
            } else {
                return;
            }
        }
    }

    fn token(&mut self) -> Option<Kind> {
        if self.ended() {
            return None;
        }
        let first = self.peek(0);
        if let Some(hashes) = self.raw_string() {
            return Some(self.raw_text(hashes));
        }
        if first == '"' || (matches!(first, 'b' | 'c') && self.peek(1) == '"') {
            self.step(if first == '"' { 0 } else { 1 });
            return Some(self.quoted_text());
        }
        if first == '\'' || (first == 'b' && self.peek(1) == '\'') {
            self.step(if first == 'b' { 1 } else { 0 });
            self.character_or_lifetime();
            return Some(Kind::Other);
        }
        if first == 'r' && self.peek(1) == '#' {
            self.step(2);
        }
        if self.peek(0).is_alphabetic() || self.peek(0) == '_' {
            return Some(Kind::Name(self.word()));
        }
        if first.is_ascii_digit() {
            self.word();
            // `1.5`, but neither `1..2` nor `1.max(2)`.
            if self.peek(0) == '.' && self.peek(1).is_ascii_digit() {
                self.step(1);
                self.word();
            }
            return Some(Kind::Other);
        }
        if first == ':' && self.peek(1) == ':' {
            self.step(2);
            return Some(Kind::Path);
        }
        self.step(1);
        Some(Kind::Mark(first))
    }

    fn word(&mut self) -> String {
        let begun = self.at;
        while self.peek(0).is_alphanumeric() || self.peek(0) == '_' {
            self.step(1);
        }
        self.chars[begun..self.at].iter().collect()
    }

    /// The number of hashes, if a raw string begins here.
    fn raw_string(&self) -> Option<usize> {
        let prefix = if matches!(self.peek(0), 'b' | 'c') && self.peek(1) == 'r' { 2 } else { 1 };
        if self.peek(prefix - 1) != 'r' {
            return None;
        }
        let hashes = (0..).take_while(|&i| self.peek(prefix + i) == '#').count();
        (self.peek(prefix + hashes) == '"').then_some(hashes)
    }

    fn raw_text(&mut self, hashes: usize) -> Kind {
        while self.peek(0) != '"' {
            self.step(1);
        }
        self.step(1);
        let begun = self.at;
        while !(self.ended() || self.peek(0) == '"' && (1..=hashes).all(|i| self.peek(i) == '#')) {
            self.step(1);
        }
        let text = self.chars[begun..self.at].iter().collect();
        self.step(1 + hashes);
        Kind::Text(text)
    }

    fn quoted_text(&mut self) -> Kind {
        self.step(1);
        let begun = self.at;
        while !self.ended() && self.peek(0) != '"' {
            self.step(if self.peek(0) == '\\' { 2 } else { 1 });
        }
        let text = self.chars[begun..self.at.min(self.chars.len())].iter().collect();
        self.step(1);
        Kind::Text(text)
    }

    fn character_or_lifetime(&mut self) {
        self.step(1);
        if self.peek(0) == '\\' {
            self.step(2);
            while self.peek(0) != '\'' {
                self.step(1);
            }
            self.step(1);
        } else if self.peek(1) == '\'' {
            self.step(2);
        } else {
            self.word();
        }
    }
}
