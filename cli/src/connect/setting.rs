//! A gain as it is set on the command line.

use std::str::FromStr;

use strainwave_service::tuning::{Function, Trial};

/// Gains of a compensation function, for forward and backward motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    pub function: Function,
    pub gains: [f32; 2],
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("allowed: NAME=GAIN or NAME=FORWARD,BACKWARD")?;
        let named = Function::ALL.into_iter().find(|function| function.name() == name);
        let function = named.ok_or_else(|| {
            format!("no gain is called {name:?}; allowed: {}", Function::ALL.map(Function::name).join(", "))
        })?;
        let (forward, backward) = value.split_once(',').unwrap_or((value, value));
        let range = || format!("{name} = {value} is out of range; allowed: 0 to 1");
        let gain = |text: &str| text.parse().map_err(|_| range());
        let gains = [gain(forward)?, gain(backward)?];
        if Trial::allows(gains) { Ok(Self { function, gains }) } else { Err(range()) }
    }
}

/// Gains that are tried, in words.
pub fn describe(trial: &Trial) -> String {
    let tried = Function::ALL.into_iter().filter_map(|function| {
        let [forward, backward] = trial.of(function)?;
        let name = function.name();
        Some(if forward == backward {
            format!("{name} {forward}")
        } else {
            format!("{name} {forward} forward, {backward} backward")
        })
    });
    let tried: Vec<_> = tried.collect();
    if tried.is_empty() { "the joint's own".into() } else { tried.join("; ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_gain_is_for_both_directions() {
        let (function, other) = (Function::WindUp, Function::KinematicError);
        assert_eq!("wind-up=0.5".parse(), Ok(Setting { function, gains: [0.5, 0.5] }));
        assert_eq!("kinematic-error=1,0".parse(), Ok(Setting { function: other, gains: [1.0, 0.0] }));
        let trial = Trial::NONE.with(function, [0.5; 2]).unwrap().with(other, [1.0, 0.0]).unwrap();
        assert_eq!(describe(&trial), "wind-up 0.5; kinematic-error 1 forward, 0 backward");
        assert_eq!(describe(&Trial::NONE), "the joint's own");
    }

    #[test]
    fn a_mistake_is_told_with_what_is_allowed() {
        let told = |text: &str| text.parse::<Setting>().unwrap_err();
        assert!(told("friction").ends_with("allowed: NAME=GAIN or NAME=FORWARD,BACKWARD"));
        assert!(
            told("drag=1").starts_with("no gain is called \"drag\"; allowed: feedback, inertia, friction, ")
        );
        for gain in ["1.01", "-1", "nan", "", "0.5,", "0.5,2", "0.1,0.2,0.3"] {
            let expected = format!("friction = {gain} is out of range; allowed: 0 to 1");
            assert_eq!(told(&format!("friction={gain}")), expected);
        }
    }
}
