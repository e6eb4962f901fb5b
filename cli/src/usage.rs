//! Help and mistakes on the command line.

use std::process::ExitCode;

use clap::error::ErrorKind;

use crate::REFUSED;
use crate::figures::complain;

/// Prints help and version as they are, and a mistake as one line.
pub fn answer(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // A closed pipe is no reason to fail.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            complain(format_args!("error: no subcommand was given; `strainwave --help` lists them"));
            ExitCode::from(REFUSED)
        }
        _ => {
            complain(format_args!("{}", one_line(&error.to_string())));
            ExitCode::from(REFUSED)
        }
    }
}

/// `clap` spreads a message over paragraphs, with the usage and a hint at the end.
fn one_line(message: &str) -> String {
    let head = message.split("\n\nUsage:").next().unwrap_or(message);
    let head = head.split("\n\nFor more information").next().unwrap_or(head);
    let joined = head.split_whitespace().collect::<Vec<_>>().join(" ");
    joined.chars().filter(|character| !character.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn a_message_of_paragraphs_becomes_one_line() {
        let message = "error: required arguments were not provided:\n  --gear <G>\n  --input <IN>\n\nUsage: x\n\nFor more";
        assert_eq!(one_line(message), "error: required arguments were not provided: --gear <G> --input <IN>");
    }
}
