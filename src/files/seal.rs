//! A line at the head of a text file that tells whether somebody has edited it since.

/// The word that marks the line.
const MARK: &str = "lichtenberg-seal";

fn checksum(text: &str) -> u64 {
    // FNV-1a, as for stream names: short, and the same everywhere.
    text.bytes()
        .filter(|&b| b != b'\r')
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// `text` under a comment line with its checksum; `comment` starts a comment.
#[must_use]
pub fn seal(comment: &str, text: &str) -> String {
    format!("{comment} {MARK} {:016x}\n{text}", checksum(text))
}

/// Is `text` anything but what [`seal`] returned?
#[must_use]
pub fn is_edited(text: &str) -> bool {
    let Some((line, rest)) = text.split_once('\n') else { return true };
    let sum = line.split_once(MARK).and_then(|(_, sum)| u64::from_str_radix(sum.trim(), 16).ok());
    sum != Some(checksum(rest))
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
    }
}
