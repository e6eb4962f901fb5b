//! Versions, as programs and packages write them.

/// The first line of what a program says of its version.
pub fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().trim().to_owned()
}

/// The first `major.minor` in a text.
pub fn version_in(text: &str) -> Option<(u32, u32)> {
    text.split([' ', '-', '(']).find_map(|word| {
        let mut numbers = word.split('.');
        Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
    })
}

/// `major.minor` of a Debian package's version: `1:7.2+dfsg-7`, `1.96.0+dfsg1-1`.
pub fn package_version(version: &str) -> Option<(u32, u32)> {
    let upstream = version.split_once(':').map_or(version, |(_, upstream)| upstream);
    let mut numbers = upstream.split(|c: char| !c.is_ascii_digit()).map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packages_epoch_and_revision_do_not_count() {
        assert_eq!(package_version("1:7.2+dfsg-7+deb12u18+b3"), Some((7, 2)));
        assert_eq!(package_version("1.96.0+dfsg1-1~deb12u2"), Some((1, 96)));
        assert_eq!(package_version("1:14.0-55.7~deb12u1"), Some((14, 0)));
        assert_eq!(package_version(""), None);
    }

    #[test]
    fn a_programs_version_is_the_first_number_with_a_point() {
        assert_eq!(version_in("QEMU emulator version 7.2.22 (Debian 1:7.2+dfsg-7)"), Some((7, 2)));
        assert_eq!(version_in("rustc 1.96.0-nightly (ac68faa20 2026-05-25)"), Some((1, 96)));
        assert_eq!(version_in("something else"), None);
    }
}
