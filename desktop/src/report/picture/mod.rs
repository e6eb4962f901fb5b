//! The picture's chapter: the flexspline in three dimensions, coloured by strain, over the motion of a scenario.
//!
//! The page draws it itself with WebGL (`picture.js`), from the numbers that this module puts into it: the shapes of
//! [`shape`], and the frames of [`motion`]. Numbers are f32, little-endian, in base64.

mod motion;
mod shape;

use data_encoding::BASE64;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;
use strainwave::Error;

use super::Chapter;
use super::scenarios::Trials;
use crate::design::joint::gear_params;
use crate::io::file::BadInput;
use crate::io::gear_file::GearFile;
use crate::plant::two_port::Build;
use crate::verify::Measured;
use crate::verify::step_response::StepResponse;
use motion::Motion;
use shape::{KINDS, M, N, Shape};

/// Nodes around the drawn cup.
pub(super) const NODES_AROUND: usize = N;

/// Motion that is shown first, where it was run.
const FIRST: &str = "s2";

const SCRIPT: &str = include_str!("picture.js");

/// All that the page draws from.
#[derive(Serialize)]
struct Data {
    /// Nodes around and along the axis.
    nodes: [usize; 2],
    /// Radius, length and ellipse of the cup (m).
    cup: [f64; 3],
    /// Of the flexspline and of the circular spline.
    teeth: [u32; 2],
    twist: String,
    ellipse: String,
    kinds: Vec<Kind>,
    motions: Vec<Played>,
    checks: String,
}

/// A kind of links.
#[derive(Serialize)]
struct Kind {
    name: &'static str,
    series: String,
    /// Ends of the colour scale: strain by torque and ellipse, by the torque alone.
    scales: [f64; 2],
}

#[derive(Serialize)]
struct Played {
    name: &'static str,
    title: String,
    interval: f64,
    frames: String,
}

/// Numbers as the page reads them.
fn packed(numbers: &[f64]) -> String {
    let bytes: Vec<_> = numbers.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect();
    BASE64.encode(&bytes)
}

impl Data {
    fn of(gear: &GearFile, trials: &Trials, steps: &StepResponse) -> Result<Self, Error> {
        let params = gear_params::<f64>(gear);
        let shape = Shape::build(&params.flexspline, params.rated_torque)?;
        let runs = trials.compensated().map(|(scenario, run)| Motion::of_run(gear, &shape, scenario, run));
        let mut motions: Vec<_> = runs.collect();
        motions.sort_by_key(|motion| motion.name);
        motions.push(Motion::of_steps(gear, &shape, steps));
        let torques = motions.iter().flat_map(|motion| &motion.frames).map(|frame| frame[2].abs());
        let largest = torques.fold(params.rated_torque, f64::max);
        let kind = |(index, (name, _)): (usize, &(&'static str, _))| Kind {
            name,
            series: packed(&shape.series(index)),
            scales: shape.scales(index, largest),
        };
        let cup = &params.flexspline.cup;
        let flexspline = 2 * gear.gear.ratio.unsigned_abs();
        Ok(Self {
            nodes: [N, M],
            cup: [cup.radius, cup.length, cup.ellipse],
            teeth: [flexspline, flexspline + 2],
            twist: packed(&shape.twist()),
            ellipse: packed(&shape.ellipse()),
            kinds: KINDS.iter().enumerate().map(kind).collect(),
            motions: motions.iter().map(Played::of).collect(),
            checks: packed(&shape.checks(params.rated_torque)?),
        })
    }
}

impl Played {
    fn of(motion: &Motion) -> Self {
        let Motion { name, title, interval, frames } = motion;
        Self { name, title: title.clone(), interval: *interval, frames: packed(frames.as_flattened()) }
    }
}

pub(super) fn chapter(
    gear: &GearFile,
    trials: &Trials,
    progress: &mut dyn FnMut(f64),
) -> Result<Chapter, BadInput> {
    let refuse =
        |error: &dyn std::fmt::Display| BadInput::message(format_args!("{}: {error}", gear.gear.name));
    let steps = StepResponse::of(gear, Build::RealTime).map_err(|error| refuse(&error))?;
    progress(0.7);
    let data = Data::of(gear, trials, &steps).map_err(|error| refuse(&error))?;
    let json = serde_json::to_string(&data).map_err(|error| refuse(&error))?;
    Ok(Chapter {
        id: "picture",
        title: "The flexspline in three dimensions",
        body: body(&data, &json),
        measured: Measured::default(),
    })
}

fn body(data: &Data, json: &str) -> Markup {
    let [flexspline, circular] = data.teeth;
    html! {
        p {
            "The cup with its rim (above), pressed into an ellipse by the wave generator, within the circular spline. Its shape and "
            "its strain are those of the condensed mesh, here " (N) "x" (M) " nodes, computed by this page from the torque "
            "and the angle in each frame. There are " (flexspline) " teeth on the flexspline and " (circular) " on the circular spline."
        }
        figure #viewer {
            canvas #scene width="960" height="600" tabindex="0" role="img"
                aria-label="The flexspline, coloured by strain; arrow keys rotate, plus and minus zoom, space plays" {}
            p #no-webgl hidden { "This browser has no WebGL: the picture cannot be drawn here. The plots of this page show the same runs." }
            noscript { p { "The picture is drawn by a script of this page, which is switched off." } }
            div.legend { span #least {} span.scale {} span #most {} span { "strain, µm/m" } }
            p #readout {}
            div.controls {
                button #play type="button" { "Play" }
                label { "motion " select #motion { @for (index, motion) in data.motions.iter().enumerate() {
                    option value=(index) selected[motion.name == FIRST] { (motion.title) }
                } } }
                label { "speed " select #speed {
                    option value="1" { "real time" } option value="0.2" { "1/5" } option value="0.05" selected { "1/20" }
                    option value="0.01" { "1/100" }
                } }
                label.long { "time " input #time type="range" min="0" max="1" step="any" value="0"; }
                label { "colour " select #kind { @for (index, kind) in data.kinds.iter().enumerate() {
                    option value=(index) { (kind.name) }
                } } }
                label { "strain " select #part {
                    option value="0" { "by torque and ellipse" } option value="1" { "by the torque alone" }
                } }
                label { "ellipse times " input #ellipse type="range" min="1" max="20" step="0.5" value="8"; output #ellipse-times {} }
                label { "torsion times " input #torsion type="range" min="1" max="200" step="1" value="100"; output #torsion-times {} }
                label { input #links type="checkbox" checked; " links" }
                label { input #generator type="checkbox" checked; " wave generator" }
                label { input #spline type="checkbox" checked; " circular spline" }
            }
            figcaption {
                "Drag, or arrow keys, to rotate; wheel after a click, or plus and minus, to zoom; space to play. At the magnification 1 it "
                "is true to scale; a larger ellipse opens the gap to the circular spline and shortens the arc of teeth in mesh. Torsion is "
                "drawn from the rim to the flange. The motion is that of the compensated joint, with the motor encoder alone. "
                span #checked {}
            }
        }
        script #picture-data type="application/json" { (PreEscaped(json.replace('<', "\\u003c"))) }
        script { (PreEscaped(SCRIPT)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the page reads them.
    fn unpacked(text: &serde_json::Value) -> Vec<f32> {
        let bytes = BASE64.decode(text.as_str().unwrap().as_bytes()).unwrap();
        bytes.chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
    }

    fn rounded(numbers: &[f64]) -> Vec<f32> {
        numbers.iter().map(|number| *number as f32).collect()
    }

    /// The page of a gear that is simulated only: its motion is that of Fig. 9.
    #[test]
    fn the_page_holds_the_numbers_of_the_model() {
        let mut gear = GearFile::default_gear();
        gear.friction.input.model = strainwave::friction::ModelName::Coulomb;
        let trials = Trials::run(&gear, |_| ()).unwrap();
        let page = chapter(&gear, &trials, &mut |_| ()).unwrap().body.into_string();
        let json =
            page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(json).unwrap();
        let params = gear_params::<f64>(&gear);
        let shape = Shape::build(&params.flexspline, params.rated_torque).unwrap();
        assert_eq!(unpacked(&data["twist"]), rounded(&shape.twist()));
        assert_eq!(unpacked(&data["ellipse"]), rounded(&shape.ellipse()));
        for (kind, (name, _)) in KINDS.iter().enumerate() {
            assert_eq!(data["kinds"][kind]["name"], *name);
            assert_eq!(unpacked(&data["kinds"][kind]["series"]), rounded(&shape.series(kind)));
        }
        let steps = StepResponse::of(&gear, Build::RealTime).unwrap();
        let motion = Motion::of_steps(&gear, &shape, &steps);
        assert_eq!(data["motions"].as_array().unwrap().len(), 1);
        assert_eq!(data["motions"][0]["name"], "fig-9");
        assert_eq!(unpacked(&data["motions"][0]["frames"]), rounded(motion.frames.as_flattened()));
        assert_eq!(unpacked(&data["checks"]), rounded(&shape.checks(params.rated_torque).unwrap()));
        assert_eq!(data["teeth"], serde_json::json!([200, 202]));
    }

    /// Every element that the script asks for is on the page, and the script asks for nothing outside it.
    #[test]
    fn the_script_finds_what_it_looks_for() {
        let gear = GearFile::default_gear();
        let steps = StepResponse::of(&gear, Build::RealTime).unwrap();
        let none = Trials::none("tested without");
        let page = body(&Data::of(&gear, &none, &steps).unwrap(), "{}").into_string();
        let ids: Vec<_> =
            SCRIPT.split("element(\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
        assert!(ids.len() > 10);
        for id in ids {
            assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
        }
        for outside in ["http", "fetch", "import", "XMLHttp", "WebSocket", "innerHTML", "eval("] {
            assert!(!SCRIPT.contains(outside), "{outside}");
        }
        assert!(!SCRIPT.contains("</script") && SCRIPT.lines().count() < 500);
    }
}
