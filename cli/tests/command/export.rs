//! `export`: the built compensator as source text; one line and nothing written where that fails.

use std::process::Command;

use strainwave::compensator::Compensator;
use strainwave_desktop::GearFile;
use strainwave_desktop::design::joint::joint_params;

use crate::bench::Bench;

/// The words in an array initialiser that begins with `open`.
fn words(text: &str, open: &str) -> Vec<u32> {
    let words = text.split_once(open).unwrap().1.split(',').filter_map(|word| word.trim().strip_prefix("0x"));
    words.map(|word| u32::from_str_radix(word, 16).unwrap()).collect()
}

#[test]
fn both_languages_hold_the_built_compensator() {
    let bench = Bench::new();
    for words in ["export g.toml --rust joint.rs --json out.json", "export g.toml --c joint.h"] {
        let answer = bench.run(words);
        assert_eq!((answer.code, answer.error.as_str()), (Some(0), ""), "{}", answer.output);
    }
    let built = joint_params(&GearFile::default_gear()).unwrap().build().unwrap();
    let [rust, c] = ["joint.rs", "joint.h"].map(|name| std::fs::read_to_string(bench.path(name)).unwrap());
    for found in [words(&rust, "= [\n"), words(&c, "= {\n")] {
        assert_eq!(Compensator::from_words(&found), Ok(&built));
        let size = bench.figures("out.json")[0]["value"].as_f64();
        assert_eq!(size, Some(4.0 * found.len() as f64));
    }
    for text in [&rust, &c] {
        let heading = text.lines().next().unwrap();
        assert!(heading.contains("the gear \"hd25-100\", built by `strainwave export`"), "{heading}");
    }
    let again = bench.run("export g.toml --rust -");
    assert_eq!((again.code, again.output), (Some(0), rust), "{}", again.error);
    assert!(again.error.contains("export.size"), "{}", again.error);
}

#[test]
fn a_c_compiler_takes_the_header() {
    let bench = Bench::new();
    bench.run("export g.toml --c joint.h");
    bench.write(
        "main.c",
        "#include \"joint.h\"\n#include \"joint.h\"\n\
         _Static_assert(sizeof strainwave_words == 4 * STRAINWAVE_WORDS, \"size\");\n\
         int main(void) {\n    \
             return !(strainwave_words[0] == STRAINWAVE_LAYOUT && strainwave_words[1] == STRAINWAVE_WORDS - 3\n        \
                 && strainwave_words[2] == STRAINWAVE_CRC32 && sizeof STRAINWAVE_GEAR == 9);\n}\n",
    );
    let program = bench.path("main");
    let compiled = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-o"])
        .args([&program, &bench.path("main.c")])
        .status();
    assert!(compiled.unwrap().success());
    assert!(Command::new(program).status().unwrap().success());
}

#[test]
fn what_cannot_be_exported_is_one_line_and_no_file() {
    let bench = Bench::new();
    let text = String::from_utf8(bench.files()[&bench.path("g.toml")].clone()).unwrap();
    bench.write("soft.toml", text.replace("k1_nm_per_rad = 3.1e4", "k1_nm_per_rad = 3.0"));
    bench.write("lugre.toml", text.replacen("model = \"bliman_sorine_2\"", "model = \"coulomb\"", 1));
    for (words, expected) in [
        (
            "soft.toml --rust joint.rs",
            "soft.toml: stiffness.k1_nm_per_rad = 3.0 is out of range; allowed, with",
        ),
        ("lugre.toml --c joint.h", "lugre.toml: friction.input.model"),
        ("none.toml --rust joint.rs", "none.toml: cannot be read: "),
        ("g.toml --rust none/joint.rs", "none/joint.rs: cannot be written: there is no folder none"),
        ("g.toml --rust g.toml", "g.toml: --rust and GEAR.toml are the same file"),
        ("g.toml --c joint.h --json joint.h", "joint.h: --json and --c are the same file"),
        ("g.toml", "the following required arguments were not provided: --rust <JOINT.rs>"),
        ("g.toml --rust joint.rs --c joint.h", "the argument '--rust <JOINT.rs>' cannot be used with"),
    ] {
        let line = bench.refused(&format!("export {words}"));
        assert!(line.starts_with("error: ") && line.contains(expected), "{line}\n{expected}");
    }
}
