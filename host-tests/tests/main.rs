//! All tests that compare the firmware's build with the desktop's, in one program: each would otherwise compile the models again.
//! Only those of the tuned constants have one of their own, as they scale constants for the whole process.

mod belt_file;
mod bounds;
mod catalogue;
mod coarse_encoder;
mod command;
mod commanded;
mod compensator;
mod compensator_laws;
mod condensed_plant;
mod control;
mod csv;
mod design;
mod divergence;
mod elementary_functions;
mod example_logs;
mod feed_forward;
mod firmware;
mod frame;
mod friction;
mod gauges;
mod gear_file;
mod identification;
mod imports;
mod jog;
mod joint_file;
mod link;
mod literal_mesh;
mod moving;
mod observer;
mod odrive;
mod operated;
mod oracle;
mod power_balance;
mod range;
mod robot;
mod sensors;
mod served;
mod sound_joints;
mod supervisor;
mod two_port;
mod vectorised;
mod words;
mod wrist;

/// A file that is no module of this program would never run.
#[test]
fn every_file_of_tests_is_run() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let program = std::fs::read_to_string(folder.join("main.rs")).unwrap();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let runs =
            ["main", "tuned_constants"].contains(&name) || program.contains(&format!("\nmod {name};\n"));
        assert!(runs, "{name} is no module of tests/main.rs");
    }
}
