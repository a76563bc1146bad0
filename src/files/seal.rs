//! A line at the head of a text file that tells whether somebody has edited it since.

/// The word that marks the line.
const MARK: &str = "lichtenberg-seal";

fn checksum(text: &str) -> u64 {
    // FNV-1a, as for stream names: short, and the same everywhere.
    text.bytes()
        .filter(|&b| b != b'\r')
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// `text` with a comment line that has its checksum: at its head, or below a first line that is a comment of two signs, which
/// tells what kind of file it is. `comment` starts a comment.
#[must_use]
pub fn seal(comment: &str, text: &str) -> String {
    let line = format!("{comment} {MARK} {:016x}\n", checksum(text));
    match text.split_once('\n') {
        Some((kind, rest)) if kind.starts_with(&comment.repeat(2)) => format!("{kind}\n{line}{rest}"),
        _ => line + text,
    }
}

/// Is `text` anything but what [`seal`] returned?
#[must_use]
pub fn is_edited(text: &str) -> bool {
    let mut lines = text.splitn(3, '\n');
    let (Some(first), Some(second)) = (lines.next(), lines.next()) else { return true };
    let third = lines.next();
    let sum = |line: &str| {
        let (_, sum) = line.split_once(MARK)?;
        u64::from_str_radix(sum.trim(), 16).ok()
    };
    let rest = third.map_or(String::new(), |third| format!("\n{third}"));
    match (sum(first), sum(second)) {
        (Some(sum), _) => sum != checksum(&format!("{second}{rest}")),
        (None, Some(sum)) => sum != checksum(&format!("{first}{rest}")),
        (None, None) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_edits() {
        let sealed = seal("//", "camera {}\n");
        assert!(!is_edited(&sealed));
        assert!(!is_edited(&sealed.replace('\n', "\r\n")));
        assert!(is_edited(&sealed.replace("camera", "Camera")));
        assert!(is_edited("camera {}\n"));
        let sealed = seal("#", "##RenderMan RIB-Structure 1.1\nversion 3.03\n");
        assert!(sealed.starts_with("##RenderMan RIB-Structure 1.1\n# lichtenberg-seal"));
        assert!(!is_edited(&sealed) && is_edited(&sealed.replace("3.03", "3.04")));
    }
}
