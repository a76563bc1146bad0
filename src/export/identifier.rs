//! Names that are safe to write: identifiers, and text that cannot leave its comment or string.

/// An identifier for POV-Ray and others made of `name`: letters, digits and underscores, a capital first, so that it
/// is never a reserved word (those are lower case).
#[must_use]
pub fn identifier(name: &str) -> String {
    let mut out = String::new();
    for word in name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()) {
        if !out.is_empty() {
            out.push('_');
        }
        let mut letters = word.chars();
        out.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        out.extend(letters);
    }
    if !out.starts_with(|c: char| c.is_ascii_alphabetic()) {
        out.insert_str(0, "Fig_");
    }
    // POV-Ray's identifiers end at 40 characters.
    out.truncate(28);
    out
}

/// The identifier of a part: `prefix`, and an identifier made of `name`, so short that POV-Ray's 40 characters leave room
/// for a suffix of seven; none of `taken`. The prefix gives way first: names of parts end in what tells them apart.
#[must_use]
pub fn part_identifier(prefix: &str, name: &str, taken: &[String]) -> String {
    const MOST: usize = 33;
    let part = identifier(name);
    let short = &prefix[..prefix.len().min((MOST - 1).saturating_sub(part.len()).max(4))];
    let id = format!("{short}_{part}");
    if id.len() <= MOST && !taken.contains(&id) {
        return id;
    }
    let numbered = |number: usize| format!("{}_{number}", &id[..id.len().min(MOST - 4)]);
    (1..).map(numbered).find(|id| !taken.contains(id)).unwrap_or(id)
}

/// `text` on one line of printable ASCII, without what could end a comment or a string.
#[must_use]
pub fn plain(text: &str) -> String {
    let safe = |c: char| if c == ' ' || c.is_ascii_graphic() { c } else { '?' };
    let line: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    line.chars()
        .map(|c| match c {
            '"' => '\'',
            '\\' => '/',
            '*' => '+',
            '`' => '\'',
            c => safe(c),
        })
        .take(200)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_capitalised_and_safe() {
        assert_eq!(identifier("elm"), "Elm");
        assert_eq!(identifier("papers/2008-fig01"), "Papers_2008_Fig01");
        assert_eq!(identifier("2008-fig01"), "Fig_2008_Fig01");
        assert_eq!(identifier("x\"; evil{}"), "X_Evil");
        assert_eq!(identifier("\u{e9}\u{e9}"), "Fig_");
    }

    #[test]
    fn text_stays_in_its_comment() {
        assert_eq!(plain("a\nb */ \"c\" \\ \u{e9}"), "a b +/ 'c' / ?");
    }
}
