//! Set-up that cannot be made: one line, exit code 2. The programs of the machine are scripts.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;

use crate::bench::{Answer, Bench};

/// apt-get on a machine whose network refuses every connection.
const REFUSED: &str = "#!/bin/sh
case \"$*\" in
--version) echo apt 2.6.1 ;;
*) echo 'E: Failed to fetch http://deb/InRelease  Connection refused' >&2; exit 100 ;;
esac
";

/// A program that can only say that it is there.
const PRESENT: &str = "#!/bin/sh\necho 1.21.22\n";

/// `setup` on a machine that has these programs and no others, with this cache folder.
fn set_up(bench: &Bench, programs: &[(&str, &str)], cache: &str) -> Answer {
    fs::create_dir(bench.path("bin")).unwrap();
    for (name, script) in programs {
        let path = bench.path("bin").join(name);
        fs::write(&path, script).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    let mut command = bench.command("setup");
    command.env("PATH", bench.path("bin")).env("STRAINWAVE_CACHE", bench.path(cache));
    Bench::answer(&mut command)
}

/// Announcements before it stand in lines of their own.
fn assert_refused(answer: &Answer, reason: &str) {
    let errors: Vec<_> = answer.error.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!((answer.code, errors.len(), answer.output.as_str()), (Some(2), 1, ""), "{}", answer.error);
    assert!(errors[0].contains(reason) && answer.error.trim_end().ends_with(errors[0]), "{}", answer.error);
}

#[test]
fn a_network_that_refuses_is_one_line() {
    let answer = set_up(&Bench::new(), &[("apt-get", REFUSED), ("dpkg-deb", PRESENT)], "cache");
    assert_refused(&answer, "Failed to fetch http://deb/InRelease  Connection refused");
}

/// A folder that nobody may write, root included.
#[test]
fn a_cache_that_cannot_be_written_is_one_line() {
    let answer = set_up(&Bench::new(), &[("apt-get", REFUSED), ("dpkg-deb", PRESENT)], "/proc/strainwave");
    assert_refused(&answer, "the cache folder /proc/strainwave/packages");
}

#[test]
fn a_machine_without_apt_is_one_line() {
    assert_refused(&set_up(&Bench::new(), &[], "cache"), "there is no apt-get to fetch it with");
}
