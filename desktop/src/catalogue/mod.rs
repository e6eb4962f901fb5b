//! Gears of sizes 8 to 58 and ratios 30 to 160, and joints that are built with them.
//!
//! [`figures`] has what catalogues say, [`gear`] the gear file that follows, [`load`] the gains of a joint with another
//! load, [`commented`] the file of a new joint with its comments, [`joints`] a Latin hypercube of joints. The files in `gears/catalogue/` are what [`Model::text`] gives, with the
//! `[baselines]` that they were tuned to.

pub mod commented;
pub mod figures;
pub mod gear;
pub mod joints;
pub mod load;
mod origin;

use std::path::Path;

pub use commented::NewJoint;
pub use gear::Model;
pub use joints::{Joint, Set};

use crate::io::gear_file::GearFile;

/// One of [`FILES`].
pub struct File {
    /// Its size and ratio.
    pub model: Model,
    /// The text of `gears/catalogue/NAME.toml`.
    pub text: &'static str,
}

macro_rules! files {
    ($($size:literal $ratio:literal $name:literal,)*) => {
        /// The gear files of the catalogue: every size, and of each the ratios at the ends of what it is made with.
        pub const FILES: &[File] = &[$(File {
            model: Model { size: $size, ratio: $ratio },
            text: include_str!(concat!("../../../gears/catalogue/", $name, ".toml")),
        }),*];
    };
}

files! {
    8 30 "hd08-030", 8 50 "hd08-050", 8 100 "hd08-100",
    11 30 "hd11-030", 11 100 "hd11-100",
    14 30 "hd14-030", 14 50 "hd14-050", 14 100 "hd14-100",
    17 30 "hd17-030", 17 50 "hd17-050", 17 120 "hd17-120",
    20 30 "hd20-030", 20 100 "hd20-100", 20 160 "hd20-160",
    25 30 "hd25-030", 25 80 "hd25-080", 25 160 "hd25-160",
    32 30 "hd32-030", 32 100 "hd32-100", 32 160 "hd32-160",
    40 50 "hd40-050", 40 160 "hd40-160",
    45 100 "hd45-100", 45 160 "hd45-160",
    50 80 "hd50-080", 50 160 "hd50-160",
    58 50 "hd58-050", 58 160 "hd58-160",
}

impl File {
    /// The gear file.
    pub fn gear(&self) -> GearFile {
        let path = format!("{}.toml", self.model.name());
        GearFile::parse(Path::new(&path), self.text.as_bytes()).expect("the gear files are tested")
    }
}
