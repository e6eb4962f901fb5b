//! Conditions on several keys of a link file.
//!
//! The library's `build` has the last word; what is here says with keys and numbers what it would refuse by a name.

use std::f64::consts::FRAC_PI_2;

use strainwave::compensator::schedule::CONTROL_PERIOD;
use strainwave::link::MOST_MODES;

use super::{LinkFile, LinkSection, PiezoSection};

/// The largest payload over the beam, as [`strainwave::link::LinkParams`] has it.
const LARGEST_PAYLOAD: f64 = 1000.0;
/// What nothing on the link goes beyond.
const LENGTH: &str = "link.length_m";

/// Conditions that do not hold, of those that read none of the `damaged` sections; the library is asked where no other is broken.
pub(super) fn faults(file: &LinkFile, damaged: &[&str]) -> Vec<String> {
    let sound = |section: &str| !damaged.contains(&section);
    let (link, piezo) =
        (Some(&file.link).filter(|_| sound("link")), file.piezo.as_ref().filter(|_| sound("piezo")));
    let of_link = link.map(|link| [along(link), payload(link), damping(link)]);
    let of_piezo = piezo.map(|piezo| [material(piezo), hysteresis(piezo)]);
    let of_both = link.zip(piezo).map(|(link, piezo)| at_most("piezo.end_m", piezo.end, link.length, LENGTH));
    let checked = of_link.into_iter().flatten().chain(of_both).chain(of_piezo.into_iter().flatten());
    let mut faults: Vec<_> = checked.filter_map(Result::err).collect();
    if faults.is_empty() && damaged.is_empty() {
        faults.extend(modes(file).and_then(|()| built(file)).err());
    }
    faults
}

fn built(file: &LinkFile) -> Result<(), String> {
    file.patch().map(drop).map_err(|error| format!("piezo: {error}"))
}

fn refuse(path: &str, value: f64, allowed: &str) -> Result<(), String> {
    Err(format!("{path} = {value} is out of range; allowed: {allowed}"))
}

fn at_most(path: &str, value: f64, most: f64, what: &str) -> Result<(), String> {
    if value <= most { Ok(()) } else { refuse(path, value, &format!("at most {what} = {most}")) }
}

/// Thickness and gauges against the length.
fn along(link: &LinkSection) -> Result<(), String> {
    let LinkSection { length, thickness, ref gauges, .. } = *link;
    at_most("link.thickness_m", thickness, length, LENGTH)?;
    for (index, place) in gauges.iter().enumerate() {
        let path = format!("link.gauges_m[{index}]");
        if *place < 0.0 {
            return refuse(&path, *place, "a number from 0");
        }
        at_most(&path, *place, length, LENGTH)?;
        if gauges[..index].contains(place) {
            return Err(format!("{path} = {place} stands there twice"));
        }
    }
    Ok(())
}

fn payload(link: &LinkSection) -> Result<(), String> {
    let beam = link.linear_density * link.length;
    let mass = LARGEST_PAYLOAD * beam;
    at_most("link.payload_kg", link.payload, mass, &format!("{LARGEST_PAYLOAD} times the beam's mass"))?;
    let inertia = mass * link.length.powi(2);
    let what = format!("{LARGEST_PAYLOAD} times the beam's mass and its length squared");
    at_most("link.payload_inertia_kg_m2", link.payload_inertia, inertia, &what)
}

fn damping(link: &LinkSection) -> Result<(), String> {
    let ratios = &link.damping_ratios;
    if ![1, link.modes].contains(&ratios.len()) {
        let (count, modes) = (ratios.len(), link.modes);
        return Err(format!(
            "link.damping_ratios has {count} entries; allowed: 1 for all modes, or one for each of link.modes = {modes}"
        ));
    }
    match ratios.iter().position(|ratio| *ratio < 0.0) {
        None => Ok(()),
        Some(at) => refuse(&format!("link.damping_ratios[{at}]"), ratios[at], "a number from 0 to 0.99"),
    }
}

fn material(piezo: &PiezoSection) -> Result<(), String> {
    if piezo.charge_constant == 0.0 {
        return refuse("piezo.charge_constant_m_per_v", 0.0, "not 0; below 0 for PZT");
    }
    let least = piezo.charge_constant.powi(2) * piezo.youngs_modulus;
    if piezo.permittivity > least {
        return Ok(());
    }
    let allowed = format!("above charge_constant_m_per_v^2*youngs_modulus_pa = {least:.3e} F/m");
    refuse("piezo.permittivity_f_per_m", piezo.permittivity, &allowed)
}

fn hysteresis(piezo: &PiezoSection) -> Result<(), String> {
    let Some(weights) = &piezo.weights else {
        let alone = "piezo.linear_share without piezo.hysteresis_weights_v";
        return piezo.linear_share.map_or(Ok(()), |_| Err(alone.into()));
    };
    if piezo.hysteresis.is_some() {
        return Err("piezo.hysteresis_width beside piezo.hysteresis_weights_v; allowed: one of them".into());
    }
    let last = weights.len() - 1;
    for (i, row) in weights.iter().enumerate() {
        for (j, weight) in row.iter().enumerate() {
            let (k, l) = (last - j, last - i);
            let mirror = weights[k][l];
            if *weight != mirror {
                let allowed = format!("its mirror image piezo.hysteresis_weights_v[{k}][{l}] = {mirror}");
                return refuse(&format!("piezo.hysteresis_weights_v[{i}][{j}]"), *weight, &allowed);
            }
        }
    }
    Ok(())
}

/// The period of control shows every mode.
fn modes(file: &LinkFile) -> Result<(), String> {
    let params = file.params::<MOST_MODES>();
    // As many steps to a radian as the shortest allowed one: all frequencies are there to be compared with the period.
    let shortest = params.longest_step().map_err(|error| format!("link: {error}"))?;
    let built = params.build(0.5 * shortest).map_err(|error| format!("link: {error}"))?;
    let longest = built.frequencies().map(|omega| FRAC_PI_2 / omega);
    let carried = longest.iter().take_while(|longest| CONTROL_PERIOD < **longest).count();
    if file.link.modes <= carried {
        return Ok(());
    }
    let first = format!(
        "a quarter of the period of mode {} is {:.3e} s, and the step is {CONTROL_PERIOD} s",
        carried + 1,
        longest[carried]
    );
    match carried {
        0 => Err(format!("link.bending_stiffness_nm2: too stiff a link to have modes: {first}")),
        _ => Err(format!(
            "link.modes = {} is out of range; allowed: at most {carried}: {first}",
            file.link.modes
        )),
    }
}
